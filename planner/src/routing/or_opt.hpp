#pragma once

#include "routing/measured_tours.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Shortens tours by moving a few stops to another place, in their own tour or another one.
class OrOpt {
 public:
  /// @pre the tours outlive it
  explicit OrOpt(MeasuredTours& tours);

  /// Makes the best move. @return whether there is one
  bool move_stops();

 private:
  struct Move {
    std::size_t from = 0, begin = 0, count = 0, to = 0, at = 0;
    bool reversed = false;
    double cost = TourProblem::kNever;  // of all tours afterwards
    [[nodiscard]] std::size_t end() const { return begin + count; }
  };
  // A tour without a stretch: the step over the gap, and the length.
  struct Rest {
    double step = 0.0, length = 0.0;  // [s]
  };
  // A step between two stops of a tour, either of which may come first.
  struct Link {
    std::uint32_t a = kNoStop, b = kNoStop;
  };
  // What a robot needs more at least for a stretch between two stops of its tour that are not in the stretch.
  // As long as that link is there, only links that are new since then may be better.
  struct LeastDetour {
    std::array<std::uint32_t, kMostMoved> stretch{};
    double added = TourProblem::kNever;  // [s]
    Link in = {};
    std::size_t found = 0;  // when, by the count of `note_links`
  };

  [[nodiscard]] std::span<const std::uint32_t> stretch_of(const Move& move) const {
    return std::span(tours_.tours[move.from]).subspan(move.begin, move.count);
  }
  [[nodiscard]] Rest rest_of(const Move& move) const;
  [[nodiscard]] bool is_link(std::size_t robot, const Link& link) const;
  void note_links();
  void find_least_detour(std::size_t robot, std::span<const std::uint32_t> stretch, std::size_t begin,
                         std::size_t end, LeastDetour& least) const;
  [[nodiscard]] double least_inner_detour(const Move& move);
  [[nodiscard]] double least_detour(const Move& move, double step_of_rest);
  [[nodiscard]] double cost_of_move(const Move& move, const Rest& rest, double added) const;
  [[nodiscard]] Move best_move_from(std::size_t from, std::size_t begin);
  void find_place(Move& move) const;
  void make(const Move& move);

  MeasuredTours& tours_;
  // `stops_after` of each tour when stops were last to be moved; empty if that was never.
  std::vector<std::vector<std::uint32_t>> after_;
  std::vector<std::vector<Link>> new_links_;       // of each tour, since then
  std::size_t links_noted_ = 0;                    // so often
  std::vector<std::vector<LeastDetour>> detours_;  // in each tour, by number of stops and the first of them
};

}  // namespace frontlux::planner::detail
