#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::bench {

/// The horizontal plane (key z) that has most free voxels, the lowest of several; nothing if none is free.
[[nodiscard]] std::optional<std::uint16_t> fullest_free_plane(const VoxelGrid& grid);

/// At most `count` free voxels, one drawn from each of `count` equal parts of all, in order of storage,
/// which is a spatial order: neighbours are close to each other.
/// @param plane  only voxels of this key z, if given
/// @param stream  which random numbers to use
[[nodiscard]] std::vector<VoxelKey> sample_free_voxels(const VoxelGrid& grid, std::size_t count,
                                                       std::optional<std::uint16_t> plane,
                                                       std::uint64_t stream);

/// Calls `visit` for the voxels that share a face with this one.
template <class Visit>
void for_each_neighbour(const VoxelKey& key, const Visit& visit) {
  for (const int step : {-1, 1})
    for (const auto& neighbour :
         {offset_key(key, step, 0, 0), offset_key(key, 0, step, 0), offset_key(key, 0, 0, step)})
      if (neighbour) visit(*neighbour);
}

/// The voxels of one state that share a face with a free voxel, each once, sorted: the frontiers, if unknown.
[[nodiscard]] std::vector<VoxelKey> voxels_beside_free(const VoxelGrid& grid, Occupancy state);

/// Voxels sorted into cubes, to find those near a place.
class VoxelIndex {
 public:
  explicit VoxelIndex(std::vector<VoxelKey> voxels);

  /// Calls `visit` for every voxel whose key differs by at most `radius` along each axis, and for some
  /// others. The order depends only on the set and the place.
  template <class Visit>
  void for_each_near(const VoxelKey& place, int radius, Visit&& visit) const {
    const KeyBox box = grown({place, place}, radius);
    for (int z = box.min.z >> kLog2Cube; z <= box.max.z >> kLog2Cube; ++z)
      for (int y = box.min.y >> kLog2Cube; y <= box.max.y >> kLog2Cube; ++y)
        for (const VoxelKey& voxel : row(box.min.x >> kLog2Cube, box.max.x >> kLog2Cube, y, z)) visit(voxel);
  }

 private:
  static constexpr int kLog2Cube = 4;
  static std::uint64_t cube_of(const VoxelKey& key);
  [[nodiscard]] std::span<const VoxelKey> row(int min_x, int max_x, int y, int z) const;

  std::vector<VoxelKey> voxels_;
};

}  // namespace frontlux::bench
