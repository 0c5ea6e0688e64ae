#pragma once

#include <frontlux/octomap.hpp>
#include <frontlux/voxel_grid.hpp>

#include <memory>

namespace frontlux::bench {

/// The pruned tree of which `grid` is the mirror. Grown from the grid's blocks, because inserting scans would
/// take hours on the largest maps. Occupied and free voxels have OctoMap's clamping probabilities.
[[nodiscard]] std::shared_ptr<octomap::OcTree> make_octree(const VoxelGrid& grid);

}  // namespace frontlux::bench
