#pragma once

#include "motion/yaw.hpp"

#include <frontlux/planner/robot.hpp>

#include <algorithm>
#include <cmath>

namespace frontlux::planner::detail {

/// Angle between two yaws [rad].
[[nodiscard]] inline double turn_between(double a, double b) { return std::abs(turn(a, b)); }

/// [s] for a distance [m] and a turn [rad]; robots that see all around need not turn.
[[nodiscard]] inline double travel_seconds(const Robot& robot, double distance, double turn) {
  return std::max(distance / robot.limits.speed,
                  robot.view.sees_all_around() ? 0.0 : turn / robot.limits.yaw_rate);
}

}  // namespace frontlux::planner::detail
