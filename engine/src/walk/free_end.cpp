#include "walk/free_end.hpp"

#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace frontlux::detail {
namespace {

// castRay reaches a crossing by at most 2^17 additions, each off by half an ulp of a time below 2^18 voxels:
// 1e-11 of that time. Its first crossing, and ours, are off by an ulp of a coordinate below 2^17 voxels, over
// the direction. 1e-9 leaves a factor of 50 and more.
constexpr double kRelativeError = 1e-9;

struct KeyLine {
  std::array<double, 3> position;  // of the origin, in voxels from key 0
  std::array<double, 3> direction;
  std::array<int, 3> step;

  // When the ray leaves a voxel along an axis, in voxels.
  [[nodiscard]] double leaves(std::size_t axis, int key) const {
    if (step[axis] == 0) return std::numeric_limits<double>::infinity();
    return (key + (step[axis] > 0 ? 1 : 0) - position[axis]) / direction[axis];
  }
  [[nodiscard]] double error(std::size_t axis, double t) const {
    return step[axis] == 0 ? 0.0 : kRelativeError * (1.0 / std::fabs(direction[axis]) + t);
  }
};

}  // namespace

std::optional<FreeEnd> find_free_end(const Lattice& lattice, const Ray& ray, const VoxelKey& key,
                                     const Eigen::Vector3f& direction) {
  KeyLine line{};
  std::array<int, 3> voxel = as_array(key);
  double last = std::numeric_limits<double>::infinity();  // when the ray leaves the key range
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    line.position[i] = static_cast<double>(ray.origin[axis]) / lattice.resolution() + Lattice::kOrigin;
    line.direction[i] = static_cast<double>(direction[axis]);
    line.step[i] = line.direction[i] > 0.0 ? 1 : line.direction[i] < 0.0 ? -1 : 0;
    last = std::min(last, line.leaves(i, line.step[i] > 0 ? Lattice::kKeysPerAxis - 1 : 0));
  }
  const bool limited = ray.max_range > 0.0;
  if (limited) last = std::min(last, ray.max_range / lattice.resolution());

  // Enter the path two voxels before its end, in a voxel whose faces are all clear of the line's rounding.
  const double start = last - 2.0;
  if (start > 0.0) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (line.step[i] == 0) continue;
      const double at = line.position[i] + start * line.direction[i];
      const double cell = std::floor(at);
      const double margin = 1e-6 + kRelativeError * start;
      if (at - cell < margin || cell + 1.0 - at < margin) return std::nullopt;
      if (!(cell >= 0.0 && cell < Lattice::kKeysPerAxis)) return std::nullopt;
      voxel[i] = static_cast<int>(cell);
    }
  }

  constexpr int kEnoughSteps = 32;
  for (int steps = 0; steps < kEnoughSteps; ++steps) {
    std::array<double, 3> t{};
    for (std::size_t i = 0; i < 3; ++i) t[i] = line.leaves(i, voxel[i]);
    const auto axis = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
    for (std::size_t i = 0; i < 3; ++i)
      if (i != axis && t[i] - t[axis] <= line.error(i, t[i]) + line.error(axis, t[axis])) return std::nullopt;
    if (voxel[axis] == (line.step[axis] < 0 ? 0 : Lattice::kKeysPerAxis - 1))
      return FreeEnd{RayStop::kLeftMap, as_key(voxel)};
    voxel[axis] += line.step[axis];
    if (limited && out_of_range(ray.origin, lattice.center(as_key(voxel)), ray.max_range))
      return FreeEnd{RayStop::kOutOfRange, as_key(voxel)};
  }
  return std::nullopt;
}

}  // namespace frontlux::detail
