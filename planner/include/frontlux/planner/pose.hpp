#pragma once

#include <frontlux/export.hpp>

#include <Eigen/Core>

#include <span>

namespace frontlux::planner {

/// Where a robot or its sensor is, in the world frame. Robots stay upright: roll and pitch are 0.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  double yaw = 0.0;                                    ///< [rad] counter-clockwise from the world's x axis
};

/// @throws std::invalid_argument naming the first viewpoint that is not finite
FRONTLUX_EXPORT void check_finite(std::span<const Pose> viewpoints);

}  // namespace frontlux::planner
