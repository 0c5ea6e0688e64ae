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
#include <span>

namespace frontlux::planner::detail {

/// |v| as OctoMap computes it: squares and sum in float, the root in double.
[[nodiscard]] inline double octomap_norm(const Eigen::Vector3f& v) {
  return std::sqrt(static_cast<double>(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
}

/// A ray of an insertion.
struct ScanRay {
  Eigen::Vector3f point;  ///< [m]
  VoxelKey key;           ///< of the voxel in which it ends
  bool has_key = false;   ///< false if the point lies outside the key range: such a ray passes nothing
  bool hit = false;       ///< whether it ends in a hit
  double reach = std::numeric_limits<double>::infinity();  ///< [m] how far it is followed at most
};

/// Where a voxel lies in a container of voxels, as a number that is linear in the key.
struct LinearPlaces {
  std::array<std::int64_t, 3> stride;
  std::int64_t base;  ///< place of the key (0, 0, 0), which may lie outside the container
  [[nodiscard]] std::int64_t at(const VoxelKey& key) const {
    return base + key.x * stride[0] + key.y * stride[1] + key.z * stride[2];
  }
};

/// A path from voxel to voxel at its beginning, in the terms of OctoMap's `computeRayKeys`.
struct PathStart {
  std::array<double, 3> t_max, t_delta;
  std::array<std::int64_t, 3> step;
  double length;
};

/// @param offset  from the origin to the end, in float as OctoMap subtracts them
/// @param reach   [m] how far it is followed at most
[[nodiscard]] inline PathStart path_start(const Lattice& lattice, const Eigen::Vector3f& origin,
                                          const VoxelKey& start, const Eigen::Vector3f& offset, float length,
                                          double reach, const LinearPlaces& places) {
  const std::array<std::uint16_t, 3> keys = {start.x, start.y, start.z};
  PathStart path;
  path.length = std::min(static_cast<double>(length), reach);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const float direction = offset[axis] / length;
    const int sign = direction > 0.0F ? 1 : direction < 0.0F ? -1 : 0;
    path.step[i] = sign * places.stride[i];
    path.t_max[i] = path.t_delta[i] = std::numeric_limits<double>::max();
    if (sign == 0) continue;
    const double border =
        lattice.center(keys[i]) + static_cast<double>(static_cast<float>(sign * lattice.resolution() * 0.5));
    path.t_max[i] = (border - static_cast<double>(origin[axis])) / static_cast<double>(direction);
    path.t_delta[i] = lattice.resolution() / static_cast<double>(std::fabs(direction));
  }
  return path;
}

/// Four paths at a time. A step waits for the one before it, so that a path alone leaves most of the
/// processor idle; and no branch predictor knows which axis is next, so all three move, two of them by 0.
class PathLanes {
 public:
  static constexpr unsigned kLanes = 4;

  /// Every lane stays at `place`.
  explicit PathLanes(std::int64_t place) {
    for (unsigned lane = 0; lane < kLanes; ++lane) park(lane, place);
  }

  void park(unsigned lane, std::int64_t place) {
    load(lane, {{1.0, 1.0, 1.0}, {0.0, 0.0, 0.0}, {0, 0, 0}, std::numeric_limits<double>::infinity()}, place,
         std::numeric_limits<std::int64_t>::min());
  }

  void load(unsigned lane, const PathStart& path, std::int64_t place, std::int64_t last) {
    Pair& pair = pairs_[lane / 2];
    const unsigned i = lane % 2;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      pair.t_max[axis][i] = path.t_max[axis];
      pair.t_delta[axis][i] = path.t_delta[axis];
      pair.step[axis][i] = path.step[axis];
    }
    pair.length[i] = path.length;
    pair.place[i] = place;
    pair.last[i] = last;
  }

  /// A step of all paths. Calls `arrived(lane)` for those that ended, `passed(lane, place)` for the others.
  template <class Arrived, class Passed>
  [[gnu::always_inline]] void advance(const Arrived& arrived, const Passed& passed) {
    std::array<Integers, 2> ended;
    for (unsigned p = 0; p < 2; ++p) ended[p] = advance(pairs_[p]);
    for (unsigned lane = 0; lane < kLanes; ++lane) {
      if (ended[lane / 2][lane % 2] != 0) [[unlikely]]
        arrived(lane);
      else
        passed(lane, pairs_[lane / 2].place[lane % 2]);
    }
  }

 private:
  using Doubles [[gnu::vector_size(16)]] = double;
  using Integers [[gnu::vector_size(16)]] = std::int64_t;
  struct Pair {
    std::array<Doubles, 3> t_max, t_delta;
    std::array<Integers, 3> step;
    Doubles length;
    Integers place, last;
  };

  [[gnu::always_inline]] static Doubles only_if(Integers mask, Doubles value) {
    return std::bit_cast<Doubles>(std::bit_cast<Integers>(value) & mask);
  }
  [[gnu::always_inline]] static Doubles smaller(Doubles a, Doubles b) { return a < b ? a : b; }

  [[gnu::always_inline]] static Integers advance(Pair& pair) {
    auto& [tx, ty, tz] = pair.t_max;
    // Ties go to z before y before x, as in OctoMap.
    const Integers x_before_y = tx < ty, not_z = smaller(tx, ty) < tz;
    const Integers x = x_before_y & not_z, y = ~x_before_y & not_z;
    tx += only_if(x, pair.t_delta[0]);
    ty += only_if(y, pair.t_delta[1]);
    tz += only_if(~not_z, pair.t_delta[2]);
    pair.place += (x & pair.step[0]) + (y & pair.step[1]) + (~not_z & pair.step[2]);
    return (pair.place == pair.last) | (smaller(smaller(tx, ty), tz) > pair.length);
  }

  std::array<Pair, 2> pairs_;
};

/// Calls `mark(lane, place)` for the voxels between `origin` and each ray's end, that of the end left out:
/// the very voxels that OctoMap's `computeRayKeys` lists, by the same operations on the same types. `mark`
/// returns false to end the path of that lane, of which there are `PathLanes::kLanes`. Some voxels are marked
/// more than once.
///
/// OctoMap's loop never ends for points so near each other that their distance is 0 in float although they
/// lie in different voxels, as (1e-30, 1e-30, 0) and (-1e-30, -1e-30, 0) do, or infinite; here such a ray
/// passes its first voxel only. Otherwise rounding can carry a path past the voxel of its end by one voxel an
/// axis at most.
template <class Mark>
void for_each_passed(const Lattice& lattice, const Eigen::Vector3f& origin, const VoxelKey& start,
                     std::span<const ScanRay> rays, const LinearPlaces& places, const Mark& mark) {
  const std::int64_t first = places.at(start);
  PathLanes lanes(first);
  std::size_t next = 0;
  const auto take_ray = [&](unsigned lane) {
    while (next < rays.size()) {
      const ScanRay& ray = rays[next++];
      if (!ray.has_key || ray.key == start) continue;
      mark(lane, first);
      const Eigen::Vector3f offset = ray.point - origin;
      const auto length = static_cast<float>(octomap_norm(offset));
      if (!(length > 1e-15F) || std::isinf(length)) continue;
      // The end of a ray that is cut off at `reach` has no place in a container of what it
      // passes.
      const bool whole = ray.reach == std::numeric_limits<double>::infinity();
      lanes.load(lane, path_start(lattice, origin, start, offset, length, ray.reach, places), first,
                 whole ? places.at(ray.key) : std::numeric_limits<std::int64_t>::min());
      return true;
    }
    return false;
  };
  unsigned busy = 0;
  const auto replace = [&](unsigned lane) {
    if (take_ray(lane)) return;
    lanes.park(lane, first);  // marks once more what the rays before it marked
    --busy;
  };
  for (unsigned lane = 0; lane < PathLanes::kLanes; ++lane) busy += take_ray(lane) ? 1U : 0U;
  while (busy != 0)
    lanes.advance(replace, [&](unsigned lane, std::int64_t place) {
      if (!mark(lane, place)) [[unlikely]]
        replace(lane);
    });
}

}  // namespace frontlux::planner::detail
