#pragma once

#include <frontlux/io/sensor_frame.hpp>

#include <cmath>
#include <optional>

namespace frontlux::io {

/// Nothing unless all numbers are finite and the quaternion has length 1, give or take a thousandth.
[[nodiscard]] inline std::optional<SensorFrame> rigid_pose(const Eigen::Vector3d& position,
                                                           const Eigen::Quaterniond& orientation) {
  constexpr double kTolerance = 1e-3;
  if (!position.allFinite() || !orientation.coeffs().allFinite()) return std::nullopt;
  if (!(std::fabs(orientation.norm() - 1.0) <= kTolerance)) return std::nullopt;
  SensorFrame pose = SensorFrame::Identity();
  pose.linear() = orientation.normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

}  // namespace frontlux::io
