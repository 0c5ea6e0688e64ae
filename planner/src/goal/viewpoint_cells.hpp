#pragma once

#include <frontlux/voxel_grid.hpp>

#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Some cells that stand for all: the smallest in each cube of `stride` voxels a side, so that narrow places
/// keep a cell, and every one within `surroundings` voxels of the robot along each axis. Sorted.
/// @param cells  sorted, each once
[[nodiscard]] std::vector<VoxelKey> viewpoint_cells(std::span<const VoxelKey> cells, int stride,
                                                    const VoxelKey& robot, int surroundings);

}  // namespace frontlux::planner::detail
