#pragma once

#include <frontlux/key_box.hpp>
#include <frontlux/voxel_grid.hpp>

#include <span>

namespace frontlux::planner::detail {

/// Whether a wide unknown space begins behind some frontiers: a few steps from them, from face to face
/// through unknown voxels, is the middle of a cube of unknown voxels beyond them.
/// @param bounds     of the cube
/// @param frontiers  sorted; none is in the cube
/// @param half       [voxels] from the cube's middle to its last ones
/// @param steps      greatest number
[[nodiscard]] bool lead_to_space(const VoxelGrid& grid, const KeyBox& bounds,
                                 std::span<const VoxelKey> frontiers, int half, int steps);

}  // namespace frontlux::planner::detail
