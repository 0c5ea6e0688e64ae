#pragma once

#include <frontlux/key_box.hpp>
#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

/// castRay's traversal (ray contract, rules 3 to 7), voxel by voxel.
namespace frontlux::detail {

/// The length by which castRay divides a direction.
inline float length_as_octomap(const Eigen::Vector3f& d) {
  // castRay takes the root in double and rounds it to float: the same, since a double has more than twice the
  // digits.
  return std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z());
}

/// A direction as castRay normalises it (rule 3): in float, and not at all if it has no length or is not a
/// number.
inline Eigen::Vector3f normalized_as_octomap(Eigen::Vector3f d) {
  const float length = length_as_octomap(d);
  if (length > 0) d = {d.x() / length, d.y() / length, d.z() / length};
  return d;
}

/// Whether a squared length is that of a direction that `normalized_as_octomap` could normalise: but for
/// vectors whose squares are too small or too large for a float, its rounding leaves at most 6e-7.
inline bool is_unit(float squared_length) { return std::fabs(squared_length - 1.0F) < 1e-6F; }
inline bool is_unit(const Eigen::Vector3f& direction) { return is_unit(direction.squaredNorm()); }

inline std::array<int, 3> as_array(const VoxelKey& key) { return {key.x, key.y, key.z}; }
inline VoxelKey as_key(const std::array<int, 3>& key) { return make_key(key[0], key[1], key[2]); }

/// The crossings of a line with the planes between voxels: Amanatides and Woo's state. `Time` is double along
/// castRay's rays, and a 64-bit integer between voxel centres, where it counts in units of 1 / (2 dx dy dz)
/// and is exact.
template <class Time>
struct Crossings {
  std::array<int, 3> step;
  std::array<Time, 3> t_max;    ///< when the line crosses into the next voxel along each axis
  std::array<Time, 3> t_delta;  ///< time between two such crossings

  [[nodiscard]] bool none() const { return step[0] == 0 && step[1] == 0 && step[2] == 0; }
};

/// Rule 4, operation by operation.
/// @param direction as `normalized_as_octomap` returns it
inline Crossings<double> crossings_of(const Lattice& lattice, const Eigen::Vector3f& origin,
                                      const VoxelKey& key, const Eigen::Vector3f& direction) {
  Crossings<double> line{};
  const std::array<int, 3> cell = as_array(key);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto d = static_cast<double>(direction[static_cast<int>(i)]);
    line.step[i] = d > 0.0 ? 1 : d < 0.0 ? -1 : 0;
    if (line.step[i] == 0) {
      line.t_max[i] = line.t_delta[i] = std::numeric_limits<double>::max();
      continue;
    }
    double border = lattice.center(static_cast<std::uint16_t>(cell[i]));
    border += line.step[i] * lattice.resolution() * 0.5;
    line.t_max[i] = (border - static_cast<double>(origin[static_cast<int>(i)])) / d;
    line.t_delta[i] = lattice.resolution() / std::fabs(d);
  }
  return line;
}

/// How many steps a line can take along each axis before the key range ends.
inline std::array<int, 3> steps_to_border(const Crossings<double>& line, const VoxelKey& from) {
  std::array<int, 3> steps = as_array(from);
  for (std::size_t i = 0; i < 3; ++i)
    if (line.step[i] > 0) steps[i] = Lattice::kKeysPerAxis - 1 - steps[i];
  return steps;
}

/// The line between two voxel centres. With time scaled by 2 dx dy dz the n-th crossing along x comes at
/// (2 n - 1) dy dz, at most 2^49.
inline Crossings<std::int64_t> crossings_of(const VoxelKey& from, const VoxelKey& to) {
  Crossings<std::int64_t> line{};
  const auto a = as_array(from), b = as_array(to);
  std::array<std::int64_t, 3> distance{};
  for (std::size_t i = 0; i < 3; ++i) {
    line.step[i] = (b[i] > a[i]) - (b[i] < a[i]);
    distance[i] = std::max(std::abs(b[i] - a[i]), 1);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    line.t_max[i] = distance[(i + 1) % 3] * distance[(i + 2) % 3];
    line.t_delta[i] = 2 * line.t_max[i];
    if (line.step[i] == 0) {
      line.t_max[i] = std::numeric_limits<std::int64_t>::max();
      line.t_delta[i] = 0;
    }
  }
  return line;
}

/// The last voxel that the path between two voxel centres visits before `to`; of no meaning if `from` is the
/// same. It is that beside it along the longest axis, of two as long along x before y before z (rule 5, from
/// the other end).
inline VoxelKey voxel_before_end(const VoxelKey& from, const VoxelKey& to) {
  const int x = from.x - to.x, y = from.y - to.y, z = from.z - to.z;
  // Without branches, since nothing foretells them.
  const int along_z = static_cast<int>(std::abs(z) > std::max(std::abs(x), std::abs(y))),
            along_y = static_cast<int>(std::abs(y) > std::abs(x)) & ~along_z, along_x = 1 - along_z - along_y;
  const auto sign_of = [](int offset) { return offset >> 31 | 1; };
  return make_key(to.x + along_x * sign_of(x), to.y + along_y * sign_of(y), to.z + along_z * sign_of(z));
}

/// Rule 7: whether the centre of a voxel, `end`, lies beyond the range.
inline bool out_of_range(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double max_range) {
  double distance_sq = 0.0;
  for (int i = 0; i < 3; ++i) {
    const float squared = (end[i] - origin[i]) * (end[i] - origin[i]);
    distance_sq += static_cast<double>(squared);
  }
  return distance_sq > max_range * max_range;
}

/// [m] If a voxel's centre is within this, no voxel on a ray's path to it is out of range. Centres never get
/// closer along a path, but from either side of a face at a power of two floats have other spaces: each of
/// two distances is off by at most 2^-24 (2 range + |centre|).
/// @param origin_sum  of the magnitudes of the origin's coordinates
inline double range_of_sure_paths(double max_range, double origin_sum) {
  constexpr double kRounding = 0x1p-21;
  return std::max(0.0, max_range * (1.0 - kRounding) - kRounding * origin_sum);
}

/// Whether the centre of a voxel, and those of all voxels on a ray's path to it, are surely in its range.
inline bool is_surely_in_range(const Ray& ray, const Eigen::Vector3f& center) {
  if (!(ray.max_range > 0.0)) return true;
  const double sure = range_of_sure_paths(ray.max_range, ray.origin.cast<double>().lpNorm<1>());
  return !out_of_range(ray.origin, center, sure);
}

/// No voxel that a ray enters before this time is out of range: a voxel's centre is less than 0.87 of its
/// edge further away than the point of entry. There is no such time if the direction is not of unit length.
inline double time_surely_in_range(double max_range, double resolution, const Eigen::Vector3f& direction) {
  if (!(max_range > 0.0)) return std::numeric_limits<double>::infinity();
  if (!is_unit(direction)) return -std::numeric_limits<double>::infinity();
  // If the origin lies on a face, the first crossings may come at times far below zero: such times mean
  // nothing.
  const double time = (max_range - resolution) * 0.999;
  return time > 0.0 ? time : -std::numeric_limits<double>::infinity();
}

/// Why and in which voxel a ray ended: what castRay itself tells.
struct RayEnd {
  RayStop stop;
  VoxelKey key;
};

/// Sets the hit of a ray that ended in a known voxel. One function for all casters, so that entry and
/// distance are equal wherever the voxel is.
/// @param direction as `normalized_as_octomap` returns it, not zero unless the ray ended where it began
void make_hit(const Lattice& lattice, const Ray& ray, const VoxelKey& origin_key,
              const Eigen::Vector3f& direction, RayStop stop, Occupancy state, const VoxelKey& key, Hit& hit);

/// Whether a voxel of this state stops a ray.
inline bool blocks(Occupancy state, UnknownPolicy unknown) {
  return state == Occupancy::kOccupied || (state == Occupancy::kUnknown && unknown == UnknownPolicy::kBlock);
}

/// The state of a voxel that stops a ray.
inline Occupancy blocker_state(const VoxelGrid& grid, const VoxelKey& blocker, UnknownPolicy unknown) {
  return unknown == UnknownPolicy::kPass ? Occupancy::kOccupied : grid.at(blocker);
}

inline RayStop stop_in(Occupancy state) {
  return state == Occupancy::kOccupied ? RayStop::kOccupied : RayStop::kUnknown;
}

/// castRay, over a grid.
Hit walk_ray(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown);

/// `RayCaster::visible` between points and between voxel centres, over a grid.
bool walk_visible(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown);
bool walk_visible(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown);

}  // namespace frontlux::detail
