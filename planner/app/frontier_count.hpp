#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <optional>

namespace frontlux::app {

/// Number of frontier voxels in `box`: unknown voxels that share a face with a free one.
///
/// Time follows the bricks of mixed states and the surface of the larger free blocks, of which a small file
/// can declare any amount.
/// @param max_surface_bricks  bricks along that surface that are looked at at most
/// @return nothing if there are more
[[nodiscard]] std::optional<std::uint64_t> count_frontiers(const VoxelGrid& grid, const KeyBox& box,
                                                           std::uint64_t max_surface_bricks);

}  // namespace frontlux::app
