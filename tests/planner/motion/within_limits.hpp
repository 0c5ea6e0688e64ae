#pragma once

#include "support/test.hpp"

#include <frontlux/planner/trajectory.hpp>

namespace frontlux::test {

/// A trajectory keeps its limits, but for a thousandth: by differences between samples of its poses alone.
/// @param step  [s] between samples
inline void expect_within(const planner::Trajectory& trajectory, const planner::MotionLimits& limits,
                          double step = 0.01) {
  constexpr double kMost = 1 + 1e-3;  // of a limit
  const auto norm = [&](const Eigen::Vector3d& v) {
    return limits.per_axis ? v.cwiseAbs().maxCoeff() : v.norm();
  };
  const auto at = [&](double time) { return trajectory.at(time).pose; };
  const int count = static_cast<int>(std::ceil((trajectory.end() - trajectory.begin()) / step)) + 1;
  double speed = 0.0, acceleration = 0.0, yaw_rate = 0.0;
  for (int i = 1; i <= count; ++i) {
    const double time = trajectory.begin() + i * step;
    const planner::Pose before = at(time - step), now = at(time), after = at(time + step);
    speed = std::max(speed, norm(now.position - before.position) / step);
    acceleration =
        std::max(acceleration, norm(after.position - 2 * now.position + before.position) / (step * step));
    yaw_rate =
        std::max(yaw_rate, std::abs(std::remainder(now.yaw - before.yaw, 2 * std::numbers::pi)) / step);
  }
  EXPECT_LE(speed, limits.speed * kMost);
  EXPECT_LE(acceleration, limits.acceleration * kMost);
  EXPECT_LE(yaw_rate, limits.yaw_rate * kMost);
}

}  // namespace frontlux::test
