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
/// A voxel that was occupied at an update stays so as long as it is part of a surface: of the occupied voxels
/// that hang together with it by faces, edges and corners one is still occupied in the map, or there are
/// `kLeastSurface` of them or more. What is neither was a stray return, or so small that the map has lost it,
/// and is free again.
class ConservativeMap {
 public:
  static constexpr std::size_t kLeastSurface = 10;  // voxels: a stray return is one, however large

  /// @param map  at the beginning
  explicit ConservativeMap(VoxelGrid map) : grid_(std::move(map)) {}

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }

  /// Takes over changes of the map.
  /// @param changed   the voxels that may have changed in it
  /// @param occupied  by robots: in these nothing else can be, so that they are free until the next update
  /// @return further voxels that may have changed here
  [[nodiscard]] std::vector<VoxelKey> update(const VoxelGrid& map, std::span<const VoxelKey> changed,
                                             std::span<const VoxelKey> occupied = {});

 private:
  VoxelGrid grid_;
  std::vector<VoxelKey> under_robots_;  // occupied but for them
};

}  // namespace frontlux::planner::detail
