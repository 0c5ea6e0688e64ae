#include "tour/travel_ways.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {

TravelWays::TravelWays(const Lattice& lattice, TravelGraph graph, std::size_t measured)
    : lattice_(lattice), graph_(std::move(graph)), measured_(measured) {}

void TravelWays::update(const TravelCorridor& corridor, std::span<const KeyBox> changed) {
  graph_.update(corridor, changed);
  from_start_.clear();
  near_.clear();
}

void TravelWays::start_from(const std::optional<VoxelKey>& cell) {
  const auto node = cell ? graph_.node(*cell) : std::nullopt;
  start_ = node ? cell : std::nullopt;
  if (node && (from_start_.empty() || from_start_[*node] != 0.0)) from_start_ = graph_.distances(*node);
}

void TravelWays::measure_from(std::span<const VoxelKey> cells) {
  std::vector<std::uint32_t> nodes;
  for (const VoxelKey& cell : cells)
    if (const auto node = graph_.node(cell); node && !near_.contains(*node)) nodes.push_back(*node);
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<std::vector<TravelGraph::Distance>> near(nodes.size());
  for_each_index(nodes.size(), [&](std::size_t i) { near[i] = graph_.near_distances(nodes[i], measured_); });
  for (std::size_t i = 0; i < nodes.size(); ++i) near_[nodes[i]] = std::move(near[i]);
}

bool TravelWays::reaches(const VoxelKey& cell) const {
  const auto node = graph_.node(cell);
  return node && start_ && from_start_[*node] != TravelGraph::kFar;
}

double TravelWays::from_start(const VoxelKey& cell) const {
  return reaches(cell) ? straightened(*start_, cell, from_start_[*graph_.node(cell)]) : TravelGraph::kFar;
}

double TravelWays::between(const VoxelKey& from, const VoxelKey& to) const {
  const auto a = graph_.node(from), b = graph_.node(to);
  if (!a || !b) return TravelGraph::kFar;
  const auto& near = near_.at(*a);
  const auto found = std::ranges::lower_bound(near, *b, {}, &TravelGraph::Distance::to);
  return found != near.end() && found->to == *b ? straightened(from, to, found->length) : TravelGraph::kFar;
}

// Nodes are wide: a way is no shorter than the straight line, and near by often that.
double TravelWays::straightened(const VoxelKey& from, const VoxelKey& to, double way) const {
  constexpr double kClear = 8.0;  // [m]
  const Eigen::Vector3d a = lattice_.exact_center(from), b = lattice_.exact_center(to);
  const double straight = (b - a).norm();
  if (straight >= way) return straight;
  const bool clear = straight < kClear && SegmentVoxels(lattice_, a, b).all_of([&](const VoxelKey& key) {
    return graph_.node(key).has_value();
  });
  return clear ? straight : way;
}

std::function<bool(const VoxelKey&)> TravelWays::around_way_to(const VoxelKey& to) const {
  if (!reaches(to)) return [](const VoxelKey&) { return false; };
  return [this, nodes = graph_.around_way(from_start_, *graph_.node(to))](const VoxelKey& cell) {
    const auto node = graph_.node(cell);
    return node && std::ranges::binary_search(nodes, *node);
  };
}

}  // namespace frontlux::planner::detail
