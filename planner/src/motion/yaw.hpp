#pragma once

#include <cmath>
#include <numbers>

namespace frontlux::planner::detail {

/// The same direction in [-pi, pi] [rad].
[[nodiscard]] inline double wrapped(double yaw) { return std::remainder(yaw, 2 * std::numbers::pi); }

/// From one yaw to another on the shorter side [rad].
[[nodiscard]] inline double turn(double from, double to) { return wrapped(to - from); }

}  // namespace frontlux::planner::detail
