#pragma once

#include "walk/walk.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <optional>

namespace frontlux::detail {

/// The end of a ray whose first blocker is known: that blocker if it is in range, else where the range, or
/// the key range, ends the ray.
/// @param start      voxel of the origin, which does not block
/// @param direction  as `normalized_as_octomap` returns it, of unit length
/// @param blocker    the first blocker on the ray's path, or none if there is none in range
RayEnd end_of(const VoxelGrid& grid, const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
              UnknownPolicy unknown, const std::optional<VoxelKey>& blocker);

/// The hit of a ray that ended there.
/// @param hit  written where it stays, since a copy would have to wait for it
void make_hit(const VoxelGrid& grid, const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
              const RayEnd& end, Hit& hit);

}  // namespace frontlux::detail
