#pragma once

#include <frontlux/planner/travel_corridor.hpp>

#include <cmath>

namespace frontlux::planner::detail {

/// Of a voxel: 0.9 m are three voxels of 0.3 m, whatever the division says.
inline constexpr double kSlack = 1e-9;

/// Along each axis: the most voxels of a body.
inline constexpr int kMaxWindow = 1024;

/// Whole voxels in a length.
[[nodiscard]] inline int voxels_in(double length, double resolution) {
  return static_cast<int>(std::floor(length / resolution + kSlack));
}

/// Voxels that cover a length.
[[nodiscard]] inline int voxels_over(double length, double resolution) {
  return static_cast<int>(std::ceil(length / resolution - kSlack));
}

/// Voxels on each side of the middle one, so that all together cover a length.
[[nodiscard]] inline int half_width(double length, double resolution) {
  return static_cast<int>(std::ceil((length / resolution - 1.0) / 2 - kSlack));
}

/// Layers of voxels from the floor to the sensor of a robot that drives.
[[nodiscard]] inline int layers_below(const TravelOptions& options, double resolution) {
  return voxels_in(options.sensor_height, resolution);
}

/// Layers above the floor that steps and slopes may reach into.
[[nodiscard]] inline int reached_from_below(const TravelOptions& options, double resolution) {
  return voxels_over(options.clearance(), resolution);
}

}  // namespace frontlux::planner::detail
