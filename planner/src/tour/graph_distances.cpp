#include "tour/graph_distances.hpp"

#include "mapping/sort_once.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {

GraphDistances::GraphDistances(const Lattice& lattice, TravelGraph graph, std::size_t measured)
    : lattice_(lattice), graph_(std::move(graph)), measured_(measured) {}

void GraphDistances::update(const TravelCorridor& corridor, std::span<const KeyBox> changed) {
  graph_.update(corridor, changed);
  from_start_.clear();
  // What was not asked for since the update before will not be soon, either.
  std::erase_if(near_, [](const auto& entry) { return !entry.second.asked; });
  for (auto& [from, near] : near_) {
    near.asked = false;
    // What was asked for in vain, since something threw, knows nothing of the changes before these.
    if (near.stale) near.distances.clear();
    near.stale =
        near.stale || std::ranges::any_of(near.distances, [&](const TravelGraph::Distance& distance) {
          return graph_.has_changed(distance.to);
        });
  }
}

void GraphDistances::start_from(const std::optional<VoxelKey>& cell) {
  const auto node = cell ? graph_.node(*cell) : std::nullopt;
  start_ = node ? cell : std::nullopt;
  if (node && (from_start_.empty() || from_start_[*node] != 0.0)) from_start_ = graph_.distances(*node);
}

void GraphDistances::measure_from(std::span<const VoxelKey> cells) {
  std::vector<std::uint32_t> nodes;
  for (const VoxelKey& cell : cells) {
    const auto node = graph_.node(cell);
    if (!node) continue;
    Near& near = near_[graph_.name_of(*node)];
    near.asked = true;
    if (near.stale) nodes.push_back(*node);
  }
  sort_once(nodes);
  std::vector<TravelGraph::Near> places;
  for (const std::uint32_t node : nodes)
    places.push_back({node, std::move(near_[graph_.name_of(node)].distances)});
  graph_.measure(places, measured_);
  for (auto& [from, distances] : places)
    near_[graph_.name_of(from)] = {.distances = std::move(distances), .stale = false};
}

bool GraphDistances::reaches(const VoxelKey& cell) const {
  const auto node = graph_.node(cell);
  return node && start_ && from_start_[*node] != TourProblem::kNever;
}

double GraphDistances::from_start(const VoxelKey& cell) const {
  return reaches(cell) ? straightened(*start_, cell, from_start_[*graph_.node(cell)]) : TourProblem::kNever;
}

double GraphDistances::between(const VoxelKey& from, const VoxelKey& to) const {
  const auto a = graph_.node(from), b = graph_.node(to);
  if (!a || !b) return TourProblem::kNever;
  const auto& near = near_.at(graph_.name_of(*a)).distances;
  const TravelGraph::Name name = graph_.name_of(*b);
  const auto found = std::ranges::lower_bound(near, name, {}, &TravelGraph::Distance::to);
  return found != near.end() && found->to == name ? straightened(from, to, found->length)
                                                  : TourProblem::kNever;
}

NumberTable GraphDistances::between(std::span<const std::optional<VoxelKey>> cells) const {
  std::vector<std::pair<TravelGraph::Name, std::size_t>> names;  // sorted as those near by are
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (const auto node = cells[i] ? graph_.node(*cells[i]) : std::nullopt)
      names.emplace_back(graph_.name_of(*node), i);
  std::ranges::sort(names);
  NumberTable distances(cells.size(), cells.size(), TourProblem::kNever);
  for_each_index(names.size(), [&](std::size_t n) {
    const auto& [from, i] = names[n];
    const auto& known = near_.at(from).distances;
    auto near = known.begin();
    for (const auto& [to, j] : names) {
      if (j >= i) continue;
      while (near != known.end() && near->to < to) ++near;
      if (near == known.end()) break;
      if (near->to == to) distances(i, j) = straightened(*cells[i], *cells[j], near->length);
    }
  });
  return distances;
}

// Nodes are wide: a path is no shorter than the straight line, and near by often that.
double GraphDistances::straightened(const VoxelKey& from, const VoxelKey& to, double distance) const {
  constexpr double kClear = 8.0;  // [m]
  const Eigen::Vector3d a = lattice_.exact_center(from), b = lattice_.exact_center(to);
  const double straight = (b - a).norm();
  if (straight >= distance) return straight;
  const bool clear = straight < kClear && SegmentVoxels(lattice_, a, b).all_of([&](const VoxelKey& key) {
    return graph_.fits(key);
  });
  return clear ? straight : distance;
}

std::optional<VoxelKey> GraphDistances::cell_on_path_to(const VoxelKey& to, const VoxelKey& robot,
                                                        double ahead) const {
  if (!reaches(to) || !reaches(robot)) return std::nullopt;
  const double length = from_start(robot) + ahead;
  if (from_start(to) <= length) return std::nullopt;
  for (const std::uint32_t node : graph_.path_back(from_start_, *graph_.node(to)))
    if (from_start_[node] <= length) return graph_.middle_cell(node);
  return std::nullopt;
}

std::function<bool(const VoxelKey&)> GraphDistances::around_path_to(const VoxelKey& to) const {
  if (!reaches(to)) return [](const VoxelKey&) { return false; };
  std::vector<bool> around(graph_.size());
  for (const std::uint32_t node : graph_.around_path(from_start_, *graph_.node(to))) around[node] = true;
  return [this, around = std::move(around)](const VoxelKey& cell) {
    const auto node = graph_.node(cell);
    return node && around[*node];
  };
}

}  // namespace frontlux::planner::detail
