#pragma once

#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>

namespace frontlux::sim {

/// How much of a world a map knows, in voxels. A voxel is known if it is free or occupied, rightly or not.
struct Coverage {
  std::uint64_t known_observable = 0, observable = 0;  ///< of the observable voxels
  std::uint64_t known_bounding = 0, bounding = 0;      ///< of all voxels within the world's bounds

  [[nodiscard]] double of_observable() const {
    return static_cast<double>(known_observable) / static_cast<double>(observable);
  }
  [[nodiscard]] double of_bounding() const {
    return static_cast<double>(known_bounding) / static_cast<double>(bounding);
  }
  friend bool operator==(const Coverage&, const Coverage&) = default;
};

/// Counts every known voxel of the map.
/// @throws std::invalid_argument if the resolutions differ
[[nodiscard]] Coverage measure(const GroundTruth& truth, const VoxelGrid& known);

}  // namespace frontlux::sim
