#pragma once

#include "tour/travel_graph.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// Dijkstra's algorithm, but nodes about as far as each other are taken in any order, and once more when they
/// turn out to be nearer. Searches after each other pay for what they reach only.
class TravelGraph::Search {
 public:
  explicit Search(const TravelGraph& graph);

  /// [m] from a node to each. The last thing to ask of it.
  [[nodiscard]] std::vector<double> take_distances(std::uint32_t from);
  /// As `TravelGraph::measure`.
  void measure(Near& place, std::size_t count);

 private:
  [[nodiscard]] std::size_t band(double length) const { return static_cast<std::size_t>(length / width_); }
  void clear();
  void set(std::uint32_t node, double length);
  std::size_t settle(std::size_t count, std::size_t bands);
  void keep(std::size_t bands);
  void run(std::uint32_t from, std::size_t count);
  void load(std::span<const Distance> before);
  [[nodiscard]] bool is_backed(std::uint32_t node) const;
  void drop_lost(std::uint32_t from);
  [[nodiscard]] std::size_t bands_of(std::size_t count) const;
  [[nodiscard]] bool mend(const Near& place, std::size_t count);
  [[nodiscard]] std::vector<Distance> sorted();

  const TravelGraph& graph_;
  const double width_;           // [m] of a band: of nodes about as far as each other
  std::vector<double> lengths_;  // [m] to each node; `kNever` to those that are not reached
  std::vector<std::uint32_t> reached_, suspects_;
  std::vector<std::uint64_t> marks_;                                 // a bit for each node: sorts them
  std::vector<std::vector<std::pair<double, std::uint32_t>>> open_;  // of each band
};

}  // namespace frontlux::planner::detail
