#pragma once

#include "rays/trial.hpp"

#include <optional>

namespace frontlux::bench {

/// Open3D's `RaycastingScene::TestOcclusions`, Embree over triangles: those of the boxes over which
/// `make_embree_ray_caster` has its own BVH, occupied and unknown voxels as blockers.
///
/// Edges and corners that a line touches, and surfaces that it grazes, are decided by Embree's rounding, so
/// some of its answers are wrong, and their fraction is printed. Its memory is that of the triangles: Open3D
/// does not tell the BVH's.
///
/// Nothing if its rays hit nothing: those of 0.16 have an empty mask, and an Embree that heeds masks, as
/// Debian 12's does, lets them through everything.
[[nodiscard]] std::optional<Peer> make_open3d_peer(const VoxelGrid& grid);

}  // namespace frontlux::bench
