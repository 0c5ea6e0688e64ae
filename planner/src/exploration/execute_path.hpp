#pragma once

#include <frontlux/planner/exploration.hpp>

#include <cstddef>
#include <span>

namespace frontlux::planner::detail {

/// Alg. 1, lines 8 to 10: brings a robot along `step.planned`, from viewpoint to viewpoint, and takes what it
/// measures there into the map. At the first viewpoint it is already, and measures nothing. It stops where a
/// scan has shown that the path ahead is not free after all. Where it cannot go, it looks at the obstacle,
/// and that pose takes the place of the viewpoint that it did not reach.
///
/// Sets `travelled`, `length`, `changed` and `blocked`.
/// @param body        of the robot, for which the path has to be free; null: the path is not checked
/// @param known_free  marked free in the map before the robot moves
/// @return how many viewpoints of the path it has been at, the first included, the look at an obstacle not
std::size_t execute_path(std::size_t robot, RobotStep& step, const BodyStencil* body, const Drive& drive,
                         Mapping& mapping, std::span<const VoxelKey> known_free = {});

}  // namespace frontlux::planner::detail
