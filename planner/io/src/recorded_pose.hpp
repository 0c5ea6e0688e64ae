#pragma once

#include <Eigen/Geometry>

#include <optional>

namespace frontlux::planner::detail {

/// Nothing unless all numbers are finite and the quaternion has length 1, give or take a thousandth.
[[nodiscard]] std::optional<Eigen::Isometry3d> pose_from(const Eigen::Vector3d& position,
                                                         const Eigen::Quaterniond& orientation);

}  // namespace frontlux::planner::detail
