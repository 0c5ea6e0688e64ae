#pragma once

#include "packet/open_voxels.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>

#include <cstdint>

/// castRay's traversal of a single ray through a table of open voxels.
namespace frontlux::detail {

/// A ray's walk.
struct LoneWalk {
  std::uint32_t stopped_at;   ///< index of the closed voxel that stops it, `kWentThrough` or `kNeverStarted`
  VoxelKey start;             ///< the voxel where it starts; this and the next only if it started
  Eigen::Vector3f direction;  ///< as `normalized_as_octomap` returns it
};

/// Follows a ray as far as `walked_length`, if it starts in an open voxel of the table.
[[nodiscard]] LoneWalk walk_alone(const Lattice& lattice, const OpenVoxels& table, const Ray& ray);
/// The same on a processor that has AVX2, or AVX-512, where the build has it.
[[nodiscard]] LoneWalk walk_alone_by_avx512(const Lattice& lattice, const OpenVoxels& table, const Ray& ray);
[[nodiscard]] LoneWalk walk_alone_by_avx2(const Lattice& lattice, const OpenVoxels& table, const Ray& ray);

}  // namespace frontlux::detail
