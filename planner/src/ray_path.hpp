#pragma once

#include <frontlux/lattice.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace frontlux::planner::detail {

/// |v| as OctoMap computes it: squares and sum in float, the root in double.
[[nodiscard]] inline double octomap_norm(const Eigen::Vector3f& v) {
  return std::sqrt(static_cast<double>(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
}

/// A ray that an insertion follows.
struct RayEnd {
  Eigen::Vector3f point;  ///< [m]
  VoxelKey key;           ///< of the voxel in which it ends
  bool has_key = false;   ///< false if the point lies outside the key range: such a ray passes nothing
  bool hit = false;       ///< whether it ends in a hit
};

/// Where a voxel lies in a container of voxels, as a number that is linear in the key.
struct LinearPlaces {
  std::array<std::int64_t, 3> stride;
  std::int64_t base;  ///< place of the key (0, 0, 0), which may lie outside the container
  [[nodiscard]] std::int64_t at(const VoxelKey& key) const {
    return base + key.x * stride[0] + key.y * stride[1] + key.z * stride[2];
  }
};

/// Calls `mark(place)` for the voxels between `origin` and `end`, that of `end` left out: the very voxels
/// that OctoMap's `computeRayKeys` lists, by the same operations on the same types. `mark` returns false to
/// stop.
///
/// OctoMap's loop never ends for points so near each other that their distance is 0 in float although they
/// lie in different voxels, as (1e-30, 1e-30, 0) and (-1e-30, -1e-30, 0) do; here such a ray passes its first
/// voxel only. Otherwise rounding can carry a path past the voxel of `end` by one voxel an axis at most.
template <class Mark>
void follow_ray(const Lattice& lattice, const Eigen::Vector3f& origin, const VoxelKey& start,
                const RayEnd& end, const LinearPlaces& places, const Mark& mark) {
  if (start == end.key) return;
  std::int64_t place = places.at(start);
  const std::int64_t last = places.at(end.key);
  if (!mark(place)) return;

  const Eigen::Vector3f way = end.point - origin;
  const auto length = static_cast<float>(octomap_norm(way));
  if (!(length > 1e-15F)) return;
  const std::array<std::uint16_t, 3> keys = {start.x, start.y, start.z};
  std::array<double, 3> t_max, t_delta;
  std::array<std::int64_t, 3> step;
  for (std::size_t i = 0; i < 3; ++i) {
    const float direction = way[static_cast<Eigen::Index>(i)] / length;
    const int sign = direction > 0.0F ? 1 : direction < 0.0F ? -1 : 0;
    step[i] = sign * places.stride[i];
    t_max[i] = t_delta[i] = std::numeric_limits<double>::max();
    if (sign == 0) continue;
    const double border =
        lattice.center(keys[i]) + static_cast<double>(static_cast<float>(sign * lattice.resolution() * 0.5));
    t_max[i] =
        (border - static_cast<double>(origin[static_cast<Eigen::Index>(i)])) / static_cast<double>(direction);
    t_delta[i] = lattice.resolution() / static_cast<double>(std::fabs(direction));
  }

  // Which axis is next is a coin toss to the branch predictor: all three move, two of them by zero.
  const auto only_if = [](std::int64_t mask, double value) {
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(value) & mask);
  };
  const auto reach = static_cast<double>(length);
  double tx = t_max[0], ty = t_max[1], tz = t_max[2];
  while (true) {
    const bool x_before_y = tx < ty;
    const std::int64_t not_z = -static_cast<std::int64_t>((x_before_y ? tx : ty) < tz);
    const std::int64_t x = -static_cast<std::int64_t>(x_before_y) & not_z, y = ~x & not_z, z = ~not_z;
    tx += only_if(x, t_delta[0]);
    ty += only_if(y, t_delta[1]);
    tz += only_if(z, t_delta[2]);
    place += (x & step[0]) + (y & step[1]) + (z & step[2]);
    if (place == last || std::min(std::min(tx, ty), tz) > reach || !mark(place)) return;
  }
}

}  // namespace frontlux::planner::detail
