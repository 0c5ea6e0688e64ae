#pragma once

#include "motion/yaw.hpp"

#include <frontlux/planner/robot.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace frontlux::planner::detail {

/// Angle between two yaws [rad].
[[nodiscard]] inline double turn_between(double a, double b) { return std::abs(turn(a, b)); }

/// [s] for a path [m] and a turn [rad]; robots that see all around need not turn.
/// @param offset [m] from its begin to its end: along it the robot may be faster than along an axis
[[nodiscard]] inline double travel_seconds(const Robot& robot, double path, const Eigen::Vector3d& offset,
                                           double turn) {
  const double speed = offset.isZero() ? robot.limits.speed : robot.limits.speed_along(offset.normalized());
  return std::max(path / speed, robot.view.sees_all_around() ? 0.0 : turn / robot.limits.yaw_rate);
}

}  // namespace frontlux::planner::detail
