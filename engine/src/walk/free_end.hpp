#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>

#include <optional>

namespace frontlux::detail {

/// Where a ray that meets no blocker ends.
struct FreeEnd {
  RayStop stop;  ///< kOutOfRange or kLeftMap
  VoxelKey key;
};

/// The end of a ray that no voxel stops: the first voxel out of range or the last one of the key range. Found
/// by arithmetic instead of voxel by voxel, for which castRay needs 0.5 ms on an unlimited ray.
/// @param key        voxel of the ray's origin
/// @param direction  as castRay normalises it, of unit length
/// @return none where rounding in castRay's own traversal could decide: then the walk must
std::optional<FreeEnd> find_free_end(const Lattice& lattice, const Ray& ray, const VoxelKey& key,
                                     const Eigen::Vector3f& direction);

}  // namespace frontlux::detail
