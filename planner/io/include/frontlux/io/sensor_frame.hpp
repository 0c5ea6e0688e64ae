#pragma once

#include <Eigen/Geometry>

namespace frontlux::io {

/// Where a sensor was, from its frame to the world's [m]. Unlike `Eigen::Isometry3d` it lies in memory alike
/// in a library and in a program that is compiled for wider vectors (-mavx, -march=native).
using SensorFrame = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;
static_assert(alignof(SensorFrame) == alignof(double));

}  // namespace frontlux::io
