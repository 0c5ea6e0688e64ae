#pragma once

#include "mapping/sort_once.hpp"

#include <frontlux/key_box.hpp>

#include <span>
#include <vector>

namespace frontlux::planner::detail {

inline constexpr int kLog2Cube = 3;  ///< [voxels] of the cubes by which changes are noted

/// The cube that holds a voxel, by its place among all cubes.
[[nodiscard]] inline VoxelKey cube_of(const VoxelKey& key) {
  return make_key(key.x >> kLog2Cube, key.y >> kLog2Cube, key.z >> kLog2Cube);
}

/// The voxels of a cube.
[[nodiscard]] inline KeyBox voxels_of_cube(const VoxelKey& cube) {
  return frontlux::cube(make_key(cube.x << kLog2Cube, cube.y << kLog2Cube, cube.z << kLog2Cube),
                        1 << kLog2Cube);
}

/// The cubes that hold some voxels; sorted, each once.
[[nodiscard]] inline std::vector<VoxelKey> cubes_of(std::span<const VoxelKey> keys) {
  std::vector<VoxelKey> cubes;
  for (const VoxelKey& key : keys)
    if (const VoxelKey cube = cube_of(key); cubes.empty() || cubes.back() != cube) cubes.push_back(cube);
  sort_once(cubes);
  return cubes;
}

}  // namespace frontlux::planner::detail
