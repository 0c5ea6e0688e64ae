#include "tour/travel_graph_search.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace frontlux::planner::detail {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

}  // namespace

TravelGraph::Search::Search(const TravelGraph& graph)
    : graph_(graph),
      width_(graph.edge_ * graph.lattice_.resolution() / 2),
      lengths_(graph.size(), TourProblem::kNever),
      marks_(graph.size() / 64 + 1) {}

void TravelGraph::Search::clear() {
  for (const std::uint32_t node : reached_) lengths_[node] = TourProblem::kNever;
  reached_.clear();
}

// A path to a node, shorter than those before or as long: from there the search goes on.
void TravelGraph::Search::set(std::uint32_t node, double length) {
  if (lengths_[node] == TourProblem::kNever) reached_.push_back(node);
  lengths_[node] = length;
  const std::size_t at = band(length);
  if (at >= open_.size()) open_.resize(at + 1);
  open_[at].emplace_back(length, node);
}

// Goes on from what is open, until the distances of so many nodes are known or the bands are at their end.
// @return the bands whose distances are known
std::size_t TravelGraph::Search::settle(std::size_t count, std::size_t bands) {
  std::size_t known = 0, now = 0;
  for (; now < std::min(open_.size(), bands) && known < count; ++now) {
    for (std::size_t i = 0; i < open_[now].size(); ++i) {
      const auto [so_far, node] = open_[now][i];
      if (so_far > lengths_[node]) continue;
      for (const auto& [to, length] : graph_.edges_of(node))
        if (const double through = so_far + static_cast<double>(length); through < lengths_[to])
          set(to, through);
    }
    for (const auto& [so_far, node] : open_[now]) known += so_far > lengths_[node] ? 0 : 1;
    open_[now].clear();
  }
  for (std::size_t later = now; later < open_.size(); ++later) open_[later].clear();
  return now;
}

// Of what is reached only so many bands.
void TravelGraph::Search::keep(std::size_t bands) {
  std::erase_if(reached_, [&](std::uint32_t node) {
    if (lengths_[node] != TourProblem::kNever && band(lengths_[node]) < bands) return false;
    lengths_[node] = TourProblem::kNever;
    return true;
  });
}

void TravelGraph::Search::run(std::uint32_t from, std::size_t count) {
  clear();
  set(from, 0.0);
  keep(settle(count, kAll));
}

std::vector<double> TravelGraph::Search::take_distances(std::uint32_t from) {
  run(from, kAll);
  return std::move(lengths_);
}

// What was reached before the last update, of nodes that are still there.
void TravelGraph::Search::load(std::span<const Distance> before) {
  clear();
  for (const auto& [name, length] : before) {
    const std::size_t cube = cube_of(name);
    if (part_of(name) >= graph_.cubes_[cube].centers.size()) continue;
    reached_.push_back(graph_.first_[cube] + part_of(name));
    lengths_[reached_.back()] = length;
  }
}

// Whether a node is as far as by way of one next to it.
bool TravelGraph::Search::is_backed(std::uint32_t node) const {
  const double own = lengths_[node];
  return std::ranges::any_of(graph_.edges_of(node), [&](const Edge& edge) {
    return lengths_[edge.to] + static_cast<double>(edge.length) == own;
  });
}

// Forgets the lengths of nodes to which no path as long as that leads any more. Notes these and all whose
// edges have changed.
void TravelGraph::Search::drop_lost(std::uint32_t from) {
  suspects_.clear();
  for (const std::uint32_t node : reached_)
    if (graph_.has_changed(graph_.names_[node])) suspects_.push_back(node);
  for (std::size_t i = 0; i < suspects_.size(); ++i) {
    const std::uint32_t node = suspects_[i];
    const double before = lengths_[node];
    if (node == from || before == TourProblem::kNever || is_backed(node)) continue;
    lengths_[node] = TourProblem::kNever;
    for (const auto& [to, length] : graph_.edges_of(node))
      if (lengths_[to] == before + static_cast<double>(length)) suspects_.push_back(to);
  }
  std::erase_if(reached_, [&](std::uint32_t node) { return lengths_[node] == TourProblem::kNever; });
}

// Takes up what was reached before the last update.
// @return whether that was enough
bool TravelGraph::Search::mend(const Near& place, std::size_t count) {
  if (place.distances.empty()) return false;
  load(place.distances);
  drop_lost(place.from);
  // Also those that are as far as before: there may be new nodes next to them.
  for (const std::uint32_t node : suspects_) {
    double nearest = lengths_[node];
    for (const auto& [to, length] : graph_.edges_of(node))
      nearest = std::min(nearest, lengths_[to] + static_cast<double>(length));
    if (nearest != TourProblem::kNever) set(node, nearest);
  }
  // If there were no more, none are left out.
  std::size_t bands = kAll;
  if (place.distances.size() >= count)
    bands = band(std::ranges::max(place.distances, {}, &Distance::length).length) + 1;
  settle(kAll, bands);
  if (bands != kAll) keep(bands);
  if (reached_.size() < count) return bands == kAll;
  keep(bands_of(count));
  return true;
}

// The least bands that hold so many nodes of those that are reached.
std::size_t TravelGraph::Search::bands_of(std::size_t count) const {
  std::vector<double> lengths(reached_.size());
  std::ranges::transform(reached_, lengths.begin(), [&](std::uint32_t node) { return lengths_[node]; });
  const auto last = lengths.begin() + static_cast<std::ptrdiff_t>(count) - 1;
  std::ranges::nth_element(lengths, last);
  return band(*last) + 1;
}

std::vector<TravelGraph::Distance> TravelGraph::Search::sorted() {
  for (const std::uint32_t node : reached_) marks_[node / 64] |= std::uint64_t{1} << (node % 64);
  std::vector<Distance> distances;
  distances.reserve(reached_.size());
  for (std::size_t i = 0; i < marks_.size(); ++i)
    for (std::uint64_t rest = std::exchange(marks_[i], 0); rest != 0; rest &= rest - 1) {
      const std::size_t node = 64 * i + static_cast<std::size_t>(std::countr_zero(rest));
      distances.push_back({graph_.names_[node], lengths_[node]});
    }
  return distances;
}

void TravelGraph::Search::measure(Near& place, std::size_t count) {
  if (!mend(place, count)) run(place.from, count);
  place.distances = sorted();
}

}  // namespace frontlux::planner::detail
