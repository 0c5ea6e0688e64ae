#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/planner/pose.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <iterator>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Of some frontiers those in a box around a path that holds all that are within a range [m] of it.
/// @param path  not empty
[[nodiscard]] inline std::vector<VoxelKey> frontiers_near_path(const Lattice& lattice,
                                                               std::span<const VoxelKey> frontiers,
                                                               std::span<const Pose> path, double range) {
  constexpr double kRounding = 1e-6;  // [m]
  Eigen::AlignedBox3d box;
  for (const Pose& pose : path) box.extend(pose.position);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(range + kRounding);
  const Eigen::AlignedBox3d around(box.min() - reach, box.max() + reach);
  std::vector<VoxelKey> near;
  std::ranges::copy_if(frontiers, std::back_inserter(near),
                       [&](const VoxelKey& key) { return around.contains(lattice.exact_center(key)); });
  return near;
}

}  // namespace frontlux::planner::detail
