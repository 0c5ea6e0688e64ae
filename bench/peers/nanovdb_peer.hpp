#pragma once

#include "rays/trial.hpp"

namespace frontlux::bench {

/// NanoVDB's own ray march, `firstActive`, over a grid whose active voxels are the blockers that a ray from
/// free space can meet, two layers deep: occupied and unknown voxels beside free ones, and those behind.
///
/// It marches in float and, after each node or voxel, steps a fixed 1.0001 voxels ahead, so it misses voxels
/// in between: some of its answers are wrong, and their fraction is printed. The second layer keeps it from
/// passing through thin surfaces.
[[nodiscard]] Peer make_nanovdb_peer(const VoxelGrid& grid);

}  // namespace frontlux::bench
