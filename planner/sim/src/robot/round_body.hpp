#pragma once

#include <Eigen/Core>

#include <array>

namespace frontlux::sim {

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Whether an upright cylinder around the origin has a point in common with a triangle, borders included.
/// @param radius, half_height  [m]
[[nodiscard]] bool cylinder_touches(double radius, double half_height, const Triangle& triangle);

/// Whether a sphere around the origin has a point in common with a triangle, borders included.
/// @param radius  [m]
[[nodiscard]] bool sphere_touches(double radius, const Triangle& triangle);

}  // namespace frontlux::sim
