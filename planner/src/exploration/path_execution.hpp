#pragma once

#include <frontlux/planner/exploration.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// What became of a robot's way.
struct PathExecution {
  std::size_t travelled = 0;         ///< viewpoints that it came to, the first included
  double length = 0.0;               ///< [m]
  std::vector<VoxelChange> changed;  ///< by the scans, sorted by key
  std::vector<VoxelKey> blocked;     ///< cells on a way that it could not go, sorted
};

/// Alg. 1, lines 8 to 10: brings a robot from viewpoint to viewpoint and takes what it measures there into
/// the map. It stops short where a scan has shown that the way on is not free after all, or where it could
/// not go.
/// @param viewpoints  the first is where it is; there it measures nothing
/// @param body  of the robot, with which the ways are checked; null: they are not
[[nodiscard]] PathExecution travel(std::size_t robot, std::span<Pose> viewpoints, const TravelOptions* body,
                             const Drive& drive, Mapping& mapping);

/// Voxels of `candidates`, in any order, that differ between two maps; sorted by key.
[[nodiscard]] std::vector<VoxelChange> differences(const VoxelGrid& before, const VoxelGrid& after,
                                                   std::vector<VoxelKey> candidates);

}  // namespace frontlux::planner::detail
