#pragma once

#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>

namespace frontlux::sim {

/// How right a map is, in voxels within the world's bounds.
struct Accuracy {
  std::uint64_t free = 0, false_free = 0;  ///< free in the map; of them, those that hold a surface
  /// Occupied; of them, those in free space that have no wall or surface voxel at any face.
  std::uint64_t occupied = 0, false_occupied = 0;
  std::uint64_t surface = 0, surface_found = 0;  ///< observable surface voxels; of them, those occupied

  [[nodiscard]] double false_free_part() const { return part(false_free, free); }
  [[nodiscard]] double false_occupied_part() const { return part(false_occupied, occupied); }
  [[nodiscard]] double surface_part() const { return part(surface_found, surface); }

  friend bool operator==(const Accuracy&, const Accuracy&) = default;

 private:
  static double part(std::uint64_t some, std::uint64_t all) {
    return all == 0 ? 0.0 : static_cast<double>(some) / static_cast<double>(all);
  }
};

/// Compares every voxel of a map with the world. Beams that graze a surface free some of its voxels, so that
/// the map of exact sensors and poses has false free voxels, too.
/// @throws std::invalid_argument if the resolutions differ
[[nodiscard]] Accuracy measure_accuracy(const GroundTruth& truth, const VoxelGrid& map);

}  // namespace frontlux::sim
