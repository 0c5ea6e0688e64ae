#pragma once

#include "support/views.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/key_box.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::test {

/// Voxel by voxel, neighbour by neighbour; sorted.
inline std::vector<VoxelKey> frontiers_by_hand(const VoxelGrid& grid, const KeyBox& bounds,
                                               Adjacency adjacency = Adjacency::kFaces) {
  std::vector<VoxelKey> frontiers;
  for_each_key(bounds, [&](const VoxelKey& key) {
    if (grid.at(key) != Occupancy::kUnknown) return;
    const bool closed = all_of(grown({key, key}, 1), [&](const VoxelKey& k) {
      const int axes = (k.x != key.x) + (k.y != key.y) + (k.z != key.z);
      return (adjacency == Adjacency::kFaces && axes != 1) || grid.at(k) != Occupancy::kFree;
    });
    if (!closed) frontiers.push_back(key);
  });
  std::ranges::sort(frontiers);
  return frontiers;
}

/// Those of the frontiers that are in view of a pose of the path, one ray after the other.
template <class Path>
std::vector<VoxelKey> seen_by_hand(const VoxelGrid& grid, const Path& path,
                                   std::span<const VoxelKey> frontiers, const FieldOfView& view) {
  const auto caster = make_grid_ray_caster(grid);
  std::vector<VoxelKey> seen;
  std::ranges::copy_if(frontiers, std::back_inserter(seen), [&](const VoxelKey& frontier) {
    const Eigen::Vector3d center = grid.lattice().exact_center(frontier);
    return std::ranges::any_of(path, [&](const auto& pose) {
      const Eigen::Vector3d& position = pose.position;
      const Segment segment{position.cast<float>(), center.cast<float>()};
      return view.contains(center - position, pose.yaw) &&
             is_visible(*caster, segment, UnknownPolicy::kBlock);
    });
  });
  return seen;
}

}  // namespace frontlux::test
