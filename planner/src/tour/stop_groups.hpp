#pragma once

#include <frontlux/ray.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// A cluster of frontiers that some robot can look at.
struct SeenCluster {
  std::uint32_t cluster = 0;  ///< its place among all
  VoxelKey middle;
  std::vector<bool> by;  ///< robots that see it from somewhere
  /// From the nearest of these robots, in units of the distance up to which something is near to it.
  double distance = 0.0;
  bool is_next = false;  ///< a robot is going there
};

/// Clusters that are one stop when tours are searched: their places among all.
using StopClusters = std::vector<std::uint32_t>;

/// Clusters near a robot one by one; of the others those together that lie in one zone and that the same
/// robots can see. Far away zones are as much wider as they are farther away. The more stops there would be,
/// the less that distance is, and of very many also what counts as near, so that neither what is far nor many
/// robots make plannings longer and longer.
/// @param zone_edge  [voxels] of zones that are not far away
[[nodiscard]] std::vector<StopClusters> group_into_stops(std::span<const SeenCluster> seen, int zone_edge);

}  // namespace frontlux::planner::detail
