#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/trajectory.hpp>

#include <vector>

namespace frontlux::planner::detail {

/// Where a trajectory leads from a time on [s]: of poses close to each other, the fewest between which it is
/// about straight.
[[nodiscard]] std::vector<Pose> poses_along(const Trajectory& trajectory, double from);

}  // namespace frontlux::planner::detail
