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

/// The beginning of a ray's path, which may go on to the end of the key range.
/// @param direction  as `normalized_as_octomap` leaves it
/// @return nothing without a direction
inline std::optional<Standing<double>> course_along(const Lattice& lattice, const Eigen::Vector3f& origin,
                                                    const VoxelKey& start, const Eigen::Vector3f& direction) {
  const Crossings<double> line = crossings_of(lattice, origin, start, direction);
  if (line.none()) return std::nullopt;
  std::array<int, 3> to_border = as_array(start);
  for (std::size_t i = 0; i < 3; ++i)
    if (line.step[i] > 0) to_border[i] = Lattice::kKeysPerAxis - 1 - to_border[i];
  return Standing<double>{start, line, to_border};
}

inline std::array<int, 3> steps_between(const VoxelKey& a, const VoxelKey& b) {
  return {std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)};
}

/// The beginning of a segment's path, which may not go beyond `to` along any axis. Where rounding left the
/// line no component along an axis, its steps stay untaken and the path oversteps along another.
/// @return nothing if rounding left it no direction at all
inline std::optional<Standing<double>> course_between(const Lattice& lattice, const Segment& segment,
                                                      const VoxelKey& from, const VoxelKey& to) {
  const Eigen::Vector3f direction = normalized_as_octomap(segment.to - segment.from);
  const Crossings<double> line = crossings_of(lattice, segment.from, from, direction);
  if (line.none()) return std::nullopt;
  return Standing<double>{from, line, steps_between(from, to)};
}
/// @pre its ends differ
inline Standing<std::int64_t> course_between(const KeySegment& segment) {
  return {segment.from, crossings_of(segment.from, segment.to), steps_between(segment.from, segment.to)};
}

/// `RayCaster::count`, over a grid.
/// @{
PathCount count_path(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown);
PathCount count_path(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown);
PathCount count_path(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown);
/// @}

}  // namespace frontlux::detail
