#pragma once

#include "support/test.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/planner/travel_corridor.hpp>

namespace frontlux::test {

/// Lengths of steps along 0 to 3 axes, in the units in which a corridor counts.
inline constexpr std::array<int, 4> kStepLengths = {0, 985, 1393, 1706};

/// The length of a step between open cells, which are `stride` voxels apart; 0 if it is not allowed, as when
/// it cuts the corner of a closed cell.
inline int length_of_step(const std::set<VoxelKey>& open, const VoxelKey& from,
                          const std::array<int, 3>& step, int stride, planner::PathMetric metric) {
  const int axes = std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]);
  if (metric == planner::PathMetric::kSteps && axes > 1) return 0;
  for (int part = 1; part < 8; ++part) {
    const auto along = [&](int axis) {
      return (part >> axis & 1) * step[static_cast<std::size_t>(axis)] * stride;
    };
    const auto cell = offset_key(from, along(0), along(1), along(2));
    if (!cell || !open.contains(*cell)) return 0;
  }
  return kStepLengths.at(static_cast<std::size_t>(axes));
}

/// Distances to all open cells that are connected with one, by Dijkstra's algorithm over a sorted set.
inline std::map<VoxelKey, int> dijkstra(const std::set<VoxelKey>& open, const VoxelKey& from, int stride,
                                        planner::PathMetric metric) {
  std::map<VoxelKey, int> distances;
  std::set<std::pair<int, VoxelKey>> queue = {{0, from}};
  while (!queue.empty()) {
    const auto [distance, cell] = queue.extract(queue.begin()).value();
    if (!open.contains(cell) || !distances.emplace(cell, distance).second) continue;
    for (int i = 0; i < 27; ++i) {
      const std::array<int, 3> step = {i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1};
      if (const int length = length_of_step(open, cell, step, stride, metric); length != 0)
        queue.emplace(distance + length,
                      *offset_key(cell, stride * step[0], stride * step[1], stride * step[2]));
    }
  }
  return distances;
}

}  // namespace frontlux::test
