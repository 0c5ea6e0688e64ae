#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

/// castRay's traversal (ray contract, rules 3 to 7), voxel by voxel, over anything that tells a voxel's
/// state.
namespace frontlux::detail {

/// A direction as castRay normalises it (rule 3): in float, and not at all if it has no length or is not a
/// number.
inline Eigen::Vector3f normalized_as_octomap(Eigen::Vector3f d) {
  const double length = std::sqrt(static_cast<double>(d.x() * d.x() + d.y() * d.y() + d.z() * d.z()));
  if (length > 0) {
    const auto divisor = static_cast<float>(length);
    d = {d.x() / divisor, d.y() / divisor, d.z() / divisor};
  }
  return d;
}

inline std::array<int, 3> as_array(const VoxelKey& key) { return {key.x, key.y, key.z}; }
inline VoxelKey as_key(const std::array<int, 3>& key) {
  return {static_cast<std::uint16_t>(key[0]), static_cast<std::uint16_t>(key[1]),
          static_cast<std::uint16_t>(key[2])};
}

/// Where a traversal stands: Amanatides and Woo's state. `Time` is double along castRay's rays, and a 64-bit
/// integer between voxel centres, where it counts in units of 1 / (2 dx dy dz) and is exact.
template <class Time>
struct Walk {
  std::array<int, 3> key;
  std::array<int, 3> step;
  std::array<Time, 3> t_max;    ///< when the ray crosses into the next voxel along each axis
  std::array<Time, 3> t_delta;  ///< time between two such crossings

  /// Ties go to z before y before x (rule 5).
  [[nodiscard]] int next_axis() const {
    if (t_max[0] < t_max[1]) return t_max[0] < t_max[2] ? 0 : 2;
    return t_max[1] < t_max[2] ? 1 : 2;
  }
  void advance(int axis) {
    const auto a = static_cast<std::size_t>(axis);
    key[a] += step[a];
    t_max[a] += t_delta[a];
  }
  [[nodiscard]] bool at_last_key(int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    return key[a] == (step[a] < 0 ? 0 : Lattice::kKeysPerAxis - 1);
  }
  [[nodiscard]] bool stands_still() const { return step[0] == 0 && step[1] == 0 && step[2] == 0; }
};

/// Rule 4, operation by operation.
/// @param direction as `normalized_as_octomap` leaves it
inline Walk<double> make_walk(const Lattice& lattice, const Eigen::Vector3f& origin, const VoxelKey& key,
                              const Eigen::Vector3f& direction) {
  Walk<double> walk{as_array(key), {}, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto d = static_cast<double>(direction[static_cast<int>(i)]);
    walk.step[i] = d > 0.0 ? 1 : d < 0.0 ? -1 : 0;
    if (walk.step[i] == 0) {
      walk.t_max[i] = walk.t_delta[i] = std::numeric_limits<double>::max();
      continue;
    }
    double border = lattice.center(static_cast<std::uint16_t>(walk.key[i]));
    border += walk.step[i] * lattice.resolution() * 0.5;
    walk.t_max[i] = (border - static_cast<double>(origin[static_cast<int>(i)])) / d;
    walk.t_delta[i] = lattice.resolution() / std::fabs(d);
  }
  return walk;
}

/// The path between two voxel centres. With time scaled by 2 dx dy dz the n-th crossing along x
/// comes at (2 n - 1) dy dz, at most 2^49.
inline Walk<std::int64_t> make_walk(const VoxelKey& from, const VoxelKey& to) {
  Walk<std::int64_t> walk{as_array(from), {}, {}, {}};
  const auto target = as_array(to);
  std::array<std::int64_t, 3> distance{};
  for (std::size_t i = 0; i < 3; ++i) {
    walk.step[i] = target[i] > walk.key[i] ? 1 : target[i] < walk.key[i] ? -1 : 0;
    distance[i] = std::abs(target[i] - walk.key[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t a = distance[(i + 1) % 3], b = distance[(i + 2) % 3];
    walk.t_max[i] = (a > 0 ? a : 1) * (b > 0 ? b : 1);
    walk.t_delta[i] = 2 * walk.t_max[i];
    if (walk.step[i] == 0) walk.t_max[i] = std::numeric_limits<std::int64_t>::max();
  }
  return walk;
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

/// The part of a ray, by time of entry into a voxel, in which no voxel can be out of range: a voxel's centre
/// is less than 0.87 of its edge further away than the point of entry. Never trusts a direction that is not
/// of unit length.
inline double time_surely_in_range(double max_range, double resolution, const Eigen::Vector3f& direction) {
  if (!(max_range > 0.0)) return std::numeric_limits<double>::infinity();
  if (!(std::fabs(direction.squaredNorm() - 1.0F) < 1e-4F)) return -std::numeric_limits<double>::infinity();
  // An origin on a face can make the first crossings come at times far below zero: then time tells nothing.
  const double time = (max_range - resolution) * 0.999;
  return time > 0.0 ? time : -std::numeric_limits<double>::infinity();
}

/// Completes a hit with what follows from the voxel it ended in. One function for all casters, so that entry
/// and distance are equal wherever the voxel is.
/// @param direction as `normalized_as_octomap` leaves it, not zero unless the ray ended where it began
Hit make_hit(const Lattice& lattice, const Ray& ray, const VoxelKey& origin_key,
             const Eigen::Vector3f& direction, RayStop stop, Occupancy state, const VoxelKey& key);

/// Whether a voxel of this state stops a ray.
inline bool blocks(Occupancy state, UnknownPolicy unknown) {
  return state == Occupancy::kOccupied || (state == Occupancy::kUnknown && unknown == UnknownPolicy::kBlock);
}

inline RayStop stop_in(Occupancy state) {
  return state == Occupancy::kOccupied ? RayStop::kOccupied : RayStop::kUnknown;
}

/// Looks up voxels along a path; cheap while the path stays in a brick.
class GridCursor {
 public:
  GridCursor(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& key)
      : grid_(&grid), unknown_(unknown) {
    enter_tile(key);
  }
  /// @param moved bits of the key, along the axis of the step, that the step changed
  void moved(const std::array<int, 3>& key, int moved) {
    if ((moved & ~7) == 0) return;
    if ((moved & ~63) != 0)
      enter_tile(as_key(key));
    else
      enter_brick(as_key(key));
  }
  /// Whether the voxel blocks; `key` must lie in the brick last moved to.
  [[nodiscard]] bool blocked(const std::array<int, 3>& key) const {
    const std::uint64_t word = (*plane_)[static_cast<std::size_t>(key[2] & 7)] ^ flip_;
    return ((word >> ((key[1] & 7) * 8 + (key[0] & 7))) & 1U) != 0;
  }
  [[nodiscard]] Occupancy state(const std::array<int, 3>& key) const { return brick_->at(as_key(key)); }

 private:
  void enter_tile(const VoxelKey& key) {
    tile_ = &grid_->tile(key);
    enter_brick(key);
  }
  void enter_brick(const VoxelKey& key) {
    brick_ = &tile_->brick(key);
    // "Not free" blocks under kBlock, "occupied" under kPass.
    plane_ = unknown_ == UnknownPolicy::kBlock ? &brick_->free : &brick_->occupied;
    flip_ = unknown_ == UnknownPolicy::kBlock ? ~std::uint64_t{0} : 0;
  }

  const VoxelGrid* grid_;
  UnknownPolicy unknown_;
  const Tile* tile_ = nullptr;
  const Brick* brick_ = nullptr;
  const std::array<std::uint64_t, 8>* plane_ = nullptr;
  std::uint64_t flip_ = 0;
};

/// castRay, over a grid.
Hit walk_ray(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown);

/// `RayCaster::visible` between points and between voxel centres, over a grid.
bool walk_visible(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown);
bool walk_visible(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown);

}  // namespace frontlux::detail
