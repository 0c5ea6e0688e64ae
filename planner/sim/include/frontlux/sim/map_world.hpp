#pragma once

#include <frontlux/sim/world.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::sim {

/// The world that a map shows: its occupied voxels are solid, everything else is free. The surface lies
/// between occupied and other voxels, in rectangles as large as rows allow, closed and without cracks. The
/// bounds are those of the known voxels. No name, no start.
/// @throws std::runtime_error if nothing is occupied, or the surface has more than 2^26 voxel faces
[[nodiscard]] World make_map_world(const VoxelGrid& grid);

/// [m] Of that world, before it is made; empty if no voxel is known.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const VoxelGrid& grid);

}  // namespace frontlux::sim
