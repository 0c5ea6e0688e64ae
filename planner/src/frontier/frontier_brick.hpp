#pragma once

#include "mapping/octree_order.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::planner::detail {

/// The frontiers in one brick, 64 voxels at a time.
[[nodiscard]] Layers frontiers_in_brick(const VoxelGrid& grid, const VoxelKey& corner, const KeyBox& bounds,
                                        Adjacency adjacency);

}  // namespace frontlux::planner::detail
