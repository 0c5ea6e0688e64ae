#pragma once

#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <vector>

namespace frontlux::test {

/// The voxels of a box.
inline std::vector<VoxelKey> keys_of(const KeyBox& box) {
  std::vector<VoxelKey> keys;
  for_each_key(box, [&keys](const VoxelKey& key) { keys.push_back(key); });
  return keys;
}

/// The voxels whose state differs between two maps, sorted.
inline std::vector<VoxelKey> changed_keys(const VoxelGrid& before, const VoxelGrid& after) {
  std::vector<VoxelKey> keys;
  for_each_change(before, after, [&](const Block& block) {
    for_each_key(cube(block.corner, 1 << block.log2_edge), [&](const VoxelKey& key) {
      if (before.at(key) != after.at(key)) keys.push_back(key);
    });
  });
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace frontlux::test
