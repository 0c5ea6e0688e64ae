#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::bench {

/// The voxels of one state that share a face with a free voxel, each once: frontiers, if `state` is unknown.
[[nodiscard]] std::vector<VoxelKey> voxels_beside_free(const VoxelGrid& grid, Occupancy state);

/// Voxels sorted into cubes, to find those near a place.
class VoxelIndex {
 public:
  explicit VoxelIndex(std::vector<VoxelKey> voxels);

  [[nodiscard]] std::size_t size() const { return voxels_.size(); }

  /// Calls `visit` for every voxel whose key differs by at most `radius` along each axis, and for some
  /// others. In an order that depends on the set and the place alone.
  template <class Visit>
  void for_each_near(const VoxelKey& place, int radius, Visit&& visit) const {
    const Cubes cubes(place, radius);
    for (int z = cubes.min[2]; z <= cubes.max[2]; ++z) {
      for (int y = cubes.min[1]; y <= cubes.max[1]; ++y) {
        for (const VoxelKey& voxel : row(cubes.min[0], cubes.max[0], y, z)) visit(voxel);
      }
    }
  }

 private:
  struct Cubes {
    Cubes(const VoxelKey& place, int radius);
    int min[3], max[3];
  };
  [[nodiscard]] std::span<const VoxelKey> row(int min_x, int max_x, int y, int z) const;

  std::vector<VoxelKey> voxels_;
};

}  // namespace frontlux::bench
