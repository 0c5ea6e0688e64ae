#pragma once

#include "mapping/octree_order.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/voxel_grid.hpp>

#include <optional>

namespace frontlux::planner::detail {

/// The brick `dx`, `dy`, `dz` bricks away from one; nothing outside the key range.
[[nodiscard]] inline std::optional<VoxelKey> neighbour_brick(const VoxelKey& corner, int dx, int dy, int dz) {
  const int x = corner.x + 8 * dx, y = corner.y + 8 * dy, z = corner.z + 8 * dz;
  if (((x | y | z) & ~0xFFFF) != 0) return std::nullopt;  // negative numbers have high bits too
  return VoxelKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                  static_cast<std::uint16_t>(z)};
}

/// The frontiers in one brick, 64 voxels at a time.
[[nodiscard]] Layers frontiers_in_brick(const VoxelGrid& grid, const VoxelKey& corner, const KeyBox& bounds,
                                        Adjacency adjacency);

}  // namespace frontlux::planner::detail
