#pragma once

#include "rays/trial.hpp"

namespace frontlux::bench {

/// NanoVDB's own ray march, `firstActive`, over a grid whose active voxels are the blockers that a ray from
/// free space can meet, two layers deep: occupied and unknown voxels beside free ones, and those behind.
///
/// It marches in float and, after each node or voxel, looks a fixed 1.0001 voxels further on, so it passes
/// over what a ray crosses in between: a share of its answers is wrong, which is printed. The second layer
/// keeps it from passing through thin surfaces.
[[nodiscard]] Peer make_nanovdb_peer(const VoxelGrid& grid);

}  // namespace frontlux::bench
