#pragma once

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/travel_corridor.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
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
  return voxels_over(options.ground_intrusion(), resolution);
}

/// [voxels] The widest gap in the ground that a robot gets over: as wide as its highest step. On a plane one
/// voxel: beams that graze the floor free single ones, and no robot that rests there measures them again.
[[nodiscard]] inline int gap_width(const TravelOptions& options, double resolution) {
  return options.motion == Motion::kGround ? voxels_in(options.step, resolution) : 1;
}

/// [m] Along x and y: where a robot that drives needs ground.
[[nodiscard]] inline Eigen::Vector2d ground_extents(const TravelOptions& options) {
  return options.ground_extents.value_or(Eigen::Vector2d(options.extents.x(), options.extents.y()));
}

/// How far from a cell, along each axis, lie the voxels that decide whether the robot fits there: those of
/// its body, and those of the ground under it.
[[nodiscard]] inline std::array<int, 3> deciding_reach(const TravelOptions& options, double resolution) {
  const BodyStencil stencil(options, resolution);
  std::array<int, 3> reach{};
  for (std::size_t a = 0; a < 3; ++a) reach[a] = std::max(-stencil.low()[a], stencil.high()[a]);
  if (!options.drives()) return reach;
  const Eigen::Vector2d extents = ground_extents(options);
  const int gap = gap_width(options, resolution);
  reach[0] = std::max({reach[0], half_width(extents.x(), resolution) + gap, options.ground_reach});
  reach[1] = std::max({reach[1], half_width(extents.y(), resolution) + gap, options.ground_reach});
  const int floor = layers_below(options, resolution) + 1;
  const int deepest =
      options.motion == Motion::kPlane
          ? 0
          : std::max(reached_from_below(options, resolution), voxels_in(options.step, resolution)) + 1;
  reach[2] = std::max(reach[2], floor + deepest);
  return reach;
}

}  // namespace frontlux::planner::detail
