#pragma once

#include "packet/open_voxels.hpp"
#include "walk/walk.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>

#include <cstdint>
#include <optional>

/// castRay's traversal of a single ray through a table of open voxels.
namespace frontlux::detail {

/// A ray that starts in an open voxel of a table.
struct TableRay {
  VoxelKey key;               ///< of the voxel where it starts
  Eigen::Vector3f direction;  ///< as `normalized_as_octomap` returns it
  Crossings<double> line;
  std::uint32_t index;  ///< of that voxel in the table, flipped so that every step adds
  std::uint32_t flip;   ///< the bits of all axes along which it descends
};

/// None if it starts elsewhere, or has no direction of unit length.
[[nodiscard]] std::optional<TableRay> enter(const Lattice& lattice, const OpenVoxels& table, const Ray& ray);

/// @param length  how far the ray is followed [m]
/// @return the index of the closed voxel that stops the ray, or `kWentThrough`
[[nodiscard]] std::uint32_t walk_alone(const OpenVoxels& table, const TableRay& ray, double length);

}  // namespace frontlux::detail
