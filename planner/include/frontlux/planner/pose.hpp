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

/// The yaw [rad] of a robot that looks along an offset; another one if the offset is vertical or zero.
[[nodiscard]] FRONTLUX_EXPORT double yaw_along(const Eigen::Vector3d& offset, double otherwise = 0.0);

/// Sum of the distances between successive viewpoints [m].
[[nodiscard]] FRONTLUX_EXPORT double path_length(std::span<const Pose> viewpoints);

/// @throws std::invalid_argument naming the first viewpoint that is not finite
FRONTLUX_EXPORT void check_finite(std::span<const Pose> viewpoints);

}  // namespace frontlux::planner
