#pragma once

#include <Eigen/Core>

namespace frontlux::planner {

/// Where a robot or its sensor is, in the world frame. Robots stay upright: roll and pitch are 0.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  double yaw = 0.0;                                    ///< [rad] counter-clockwise from the world's x axis
};

}  // namespace frontlux::planner
