#include "walk/free_end.hpp"

#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace frontlux::detail {

std::optional<RayEnd> find_free_end(const Lattice& lattice, const Ray& ray, const VoxelKey& key,
                                    const Eigen::Vector3f& direction) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // All times are in voxels.
  std::array<double, 3> position{};  // of the origin, from key 0
  std::array<double, 3> between{};   // from one crossing to the next, below 0 where the line descends
  std::array<int, 3> step{}, voxel = as_array(key);
  const auto leaves = [&](std::size_t i, int cell) {
    return step[i] == 0 ? kNever : (cell + (step[i] > 0 ? 1 : 0) - position[i]) * between[i];
  };
  double last = kNever;  // when the ray leaves the key range, or its range ends
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const auto d = static_cast<double>(direction[axis]);
    position[i] = static_cast<double>(ray.origin[axis]) * lattice.voxels_per_metre() + Lattice::kOrigin;
    step[i] = d > 0.0 ? 1 : d < 0.0 ? -1 : 0;
    between[i] = step[i] == 0 ? 0.0 : 1.0 / d;
    last = std::min(last, leaves(i, step[i] > 0 ? Lattice::kKeysPerAxis - 1 : 0));
  }
  const bool limited = ray.max_range > 0.0;
  if (limited) last = std::min(last, ray.max_range * lattice.voxels_per_metre());

  // The path is entered a voxel before its end, where no centre is out of range: it is at most 0.87 away, and
  // the rounding of the direction's length and of centres makes at most 0.09. All faces of that voxel have to
  // be clear of the line's rounding.
  const double start = last - 1.0, margin = margin_of_entry(last);
  if (start > 0.0) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (step[i] == 0) continue;
      const double at = position[i] + start * static_cast<double>(direction[static_cast<Eigen::Index>(i)]);
      if (!(at >= 0.0 && at < Lattice::kKeysPerAxis)) return std::nullopt;
      voxel[i] = static_cast<int>(at);
      const double inside = at - voxel[i];
      if (inside < margin || 1.0 - inside < margin) return std::nullopt;
    }
  }

  std::array<double, 3> t{}, error{};
  for (std::size_t i = 0; i < 3; ++i) {
    t[i] = leaves(i, voxel[i]);
    error[i] = error_of_crossing(std::fabs(between[i]), last);
  }
  for (int steps = 0; steps < kMostStepsToEnd; ++steps) {
    const std::size_t first = t[0] < t[1] ? 0 : 1, axis = t[first] < t[2] ? first : 2;
    for (std::size_t i = 0; i < 3; ++i)
      if (i != axis && t[i] - t[axis] <= error[i] + error[axis]) return std::nullopt;
    if (voxel[axis] == (step[axis] < 0 ? 0 : Lattice::kKeysPerAxis - 1))
      return RayEnd{RayStop::kLeftMap, as_key(voxel)};
    voxel[axis] += step[axis];
    if (limited && out_of_range(ray.origin, lattice.center(as_key(voxel)), ray.max_range))
      return RayEnd{RayStop::kOutOfRange, as_key(voxel)};
    t[axis] = leaves(axis, voxel[axis]);
  }
  return std::nullopt;
}

}  // namespace frontlux::detail
