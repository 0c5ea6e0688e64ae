#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// The map in motion, in which surfaces stay: rays that graze one free some of its voxels, until they are hit
/// again. What is behind those is no frontier, and robots keep off them.
///
/// A voxel that was occupied stays so as long as it is part of a surface: of the occupied voxels that hang
/// together with it by faces, edges and corners one is still occupied in the map, or there are
/// `kLeastSurface` of them or more. What is neither was a stray return, and is free again.
class ConservativeMap {
 public:
  static constexpr std::size_t kLeastSurface = 10;

  /// @param map  at the beginning
  explicit ConservativeMap(VoxelGrid map) : grid_(std::move(map)) {}

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }

  /// Of a voxel in which nothing can be, whatever it was before.
  void set_free(const VoxelKey& key) { grid_.set(key, Occupancy::kFree); }

  /// Takes over changes of the map.
  /// @param changed  the voxels that may have changed in it
  /// @return further ones that have become free here, since with them the last of a stray return's are free
  [[nodiscard]] std::vector<VoxelKey> update(const VoxelGrid& map, std::span<const VoxelKey> changed);

 private:
  VoxelGrid grid_;
};

}  // namespace frontlux::planner::detail
