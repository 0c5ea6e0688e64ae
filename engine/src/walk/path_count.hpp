#pragma once

#include "walk/cube_skip.hpp"
#include "walk/walk.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>

namespace frontlux::detail {

/// The start of a ray's path, which may go on to the end of the key range.
/// @param direction  as `normalized_as_octomap` returns it
/// @return none without a direction
inline std::optional<PathState<double>> path_along(const Lattice& lattice, const Eigen::Vector3f& origin,
                                                   const VoxelKey& start, const Eigen::Vector3f& direction) {
  const Crossings<double> line = crossings_of(lattice, origin, start, direction);
  if (line.none()) return std::nullopt;
  return PathState<double>{start, line, steps_to_border(line, start)};
}

inline std::array<int, 3> steps_between(const VoxelKey& a, const VoxelKey& b) {
  return {std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)};
}

/// The start of a segment's path, which may not go beyond `to` along any axis. If rounding made a component
/// of the line zero, the steps along that axis are never taken, and the path oversteps along another.
/// @return none if rounding made all components zero
inline std::optional<PathState<double>> path_between(const Lattice& lattice, const Segment& segment,
                                                     const VoxelKey& from, const VoxelKey& to) {
  const Eigen::Vector3f direction = normalized_as_octomap(segment.to - segment.from);
  const Crossings<double> line = crossings_of(lattice, segment.from, from, direction);
  if (line.none()) return std::nullopt;
  return PathState<double>{from, line, steps_between(from, to)};
}
/// @pre its ends differ
inline PathState<std::int64_t> path_between(const KeySegment& segment) {
  return {segment.from, crossings_of(segment.from, segment.to), steps_between(segment.from, segment.to)};
}

/// `RayCaster::count`, over a grid.
/// @{
PathCount count_path(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown);
PathCount count_path(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown);
PathCount count_path(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown);
/// @}

}  // namespace frontlux::detail
