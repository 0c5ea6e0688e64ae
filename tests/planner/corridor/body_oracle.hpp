#pragma once

#include "support/voxel_keys.hpp"

#include <frontlux/planner/travel_corridor.hpp>

#include <Eigen/Geometry>

namespace frontlux::test {

/// [m] The cube of a voxel.
inline Eigen::AlignedBox3d cube_of(const Lattice& lattice, const VoxelKey& key) {
  const Eigen::Vector3d center = lattice.exact_center(key),
                        half = Eigen::Vector3d::Constant(lattice.resolution() / 2);
  return {center - half, center + half};
}

/// [m] How deep a body in space with its margin reaches into a voxel: how much less it may grow, or has to
/// shrink, so that both just touch. Below 0 if they are apart. A cylinder and a box grow along each axis.
inline double depth_in(const planner::TravelOptions& travel, const Eigen::Vector3d& at,
                       const Eigen::AlignedBox3d& cube) {
  const Eigen::Vector3d half = travel.extents / 2 + Eigen::Vector3d::Constant(travel.margin);
  const auto off = [&](int axis) {
    return std::max({0.0, cube.min()[axis] - at[axis], at[axis] - cube.max()[axis]});
  };
  switch (travel.shape) {
    case planner::BodyShape::kBox:
      return std::min({half.x() - off(0), half.y() - off(1), half.z() - off(2)});
    case planner::BodyShape::kCylinder:
      return std::min(half.x() - std::sqrt(off(0) * off(0) + off(1) * off(1)), half.z() - off(2));
    case planner::BodyShape::kSphere:
      return half.x() - std::sqrt(off(0) * off(0) + off(1) * off(1) + off(2) * off(2));
  }
  return 0.0;
}

/// The voxels near enough to a point for a body there to reach them, and more.
inline KeyBox voxels_near(const planner::TravelOptions& travel, const Lattice& lattice,
                          const Eigen::Vector3d& at) {
  const VoxelKey key = lattice.key(at).value();
  const double reach = travel.extents.maxCoeff() / 2 + travel.margin;
  return grown({key, key}, static_cast<int>(std::ceil(reach / lattice.resolution())) + 1);
}

/// Bodies of all shapes and several sizes and margins, in space.
inline std::vector<planner::TravelOptions> bodies_in_space() {
  std::vector<planner::TravelOptions> bodies;
  for (const auto shape :
       {planner::BodyShape::kBox, planner::BodyShape::kCylinder, planner::BodyShape::kSphere})
    for (const double width : {0.08, 0.3, 0.5, 0.55, 0.72})
      for (const double margin : {0.0, 0.05, 0.13}) {
        planner::TravelOptions travel;
        travel.shape = shape;
        travel.extents = Eigen::Vector3d(width, width, width);
        if (shape != planner::BodyShape::kSphere) travel.extents.z() = 0.4 * width + 0.1;
        travel.margin = margin;
        travel.min_height = -100.0;
        bodies.push_back(travel);
      }
  return bodies;
}

}  // namespace frontlux::test
