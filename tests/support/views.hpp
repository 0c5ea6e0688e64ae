#pragma once

#include "support/test.hpp"

#include <frontlux/field_of_view.hpp>
#include <frontlux/ray_caster.hpp>

namespace frontlux::test {

inline constexpr double kDegree = std::numbers::pi / 180;

/// The shapes of the paper's sensors, and a sonar.
inline FieldOfView lidar(double range = 6.0) {
  return {FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, range};
}
inline FieldOfView camera(double range = 10.0) {
  return {FieldOfView::Shape::kPyramid, 90 * kDegree, 72 * kDegree, range};
}
inline FieldOfView cone(double opening, double range) {
  return {FieldOfView::Shape::kCone, opening, 0.0, range};
}

/// From one voxel's centre to another's [m].
inline Eigen::Vector3d offset_between(const VoxelKey& from, const VoxelKey& to, double resolution) {
  return Eigen::Vector3d(to.x - from.x, to.y - from.y, to.z - from.z) * resolution;
}

/// One ray, between the centres of voxels or between points.
inline bool is_visible(const RayCaster& caster, const KeySegment& segment, UnknownPolicy unknown) {
  std::uint8_t visible = 0;
  caster.visible({&segment, 1}, {&visible, 1}, unknown);
  return visible != 0;
}
inline bool is_visible(const RayCaster& caster, const Segment& segment, UnknownPolicy unknown) {
  std::uint8_t visible = 0;
  caster.visible({&segment, 1}, {&visible, 1}, unknown);
  return visible != 0;
}

}  // namespace frontlux::test
