#pragma once

#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>

#include <span>
#include <vector>

namespace frontlux::bench {

/// A tour through all stops of a robot.
struct HindsightTour {
  std::vector<VoxelKey> cells;  ///< the start's, then those of the stops, each once, in the tour's order
  double length = 0.0;          ///< [m] of the shortest paths, made straight where there is room
  double in_order = 0.0;        ///< [m] of such paths, with the stops in the robot's own order
};

/// The shortest open tour that is found, from a robot's start through all of its stops, when the whole map is
/// known: its own order, and nearest neighbours with each stop as the first one, each improved by 2-opt and
/// Or-opt until no change helps. Stops in the same cell are one. The robot fits wherever it went, whatever
/// the map says; so it can go as it went.
/// @param map    at the end of the run
/// @param path   where the robot went, from its start on; straight in between [m]
/// @param stops  of these places, in the robot's order [m]
/// @throws std::invalid_argument if the path is empty, or naming a place outside of the bounds or a stop off
/// the path
[[nodiscard]] HindsightTour hindsight_tour(planner::TravelOptions travel, VoxelGrid map, const KeyBox& bounds,
                                           std::span<const Eigen::Vector3d> path,
                                           std::span<const Eigen::Vector3d> stops);

}  // namespace frontlux::bench
