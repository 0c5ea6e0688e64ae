#pragma once

#include <frontlux/export.hpp>

#include <Eigen/Core>

#include <numbers>

namespace frontlux::planner {

/// How fast a robot may move and turn.
struct FRONTLUX_EXPORT MotionLimits {
  double speed = 1.0;                      ///< [m/s]
  double acceleration = 2.0;               ///< [m/s2], curves included
  double yaw_rate = std::numbers::pi / 3;  ///< [rad/s]
  /// Speed and acceleration hold for x, y and z each, so that diagonals are faster; else for the norm.
  bool per_axis = false;

  /// The greatest speed [m/s] straight along a direction of length 1.
  [[nodiscard]] double speed_along(const Eigen::Vector3d& direction) const {
    return per_axis ? speed / direction.cwiseAbs().maxCoeff() : speed;
  }
  /// The greatest acceleration [m/s2] straight along a direction of length 1.
  [[nodiscard]] double acceleration_along(const Eigen::Vector3d& direction) const {
    return per_axis ? acceleration / direction.cwiseAbs().maxCoeff() : acceleration;
  }

  /// @throws std::invalid_argument naming the value that is not finite, or less than a thousandth
  void check() const;

  friend bool operator==(const MotionLimits&, const MotionLimits&) = default;
};

}  // namespace frontlux::planner
