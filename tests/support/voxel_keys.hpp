#pragma once

#include "support/test.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::test {

/// The voxel at an offset from the one whose lower corner is the origin [voxels].
constexpr VoxelKey key_at(int x, int y, int z) {
  return make_key(Lattice::kOrigin + x, Lattice::kOrigin + y, Lattice::kOrigin + z);
}

/// The voxels of a box.
inline std::vector<VoxelKey> keys_of(const KeyBox& box) {
  std::vector<VoxelKey> keys;
  for_each_key(box, [&keys](const VoxelKey& key) { keys.push_back(key); });
  return keys;
}

inline void fill(VoxelGrid& grid, const KeyBox& box, Occupancy state) {
  for_each_key(box, [&](const VoxelKey& key) { grid.set(key, state); });
}

inline bool is_free(const VoxelGrid& grid, const KeyBox& box) {
  return all_of(box, [&](const VoxelKey& key) { return grid.at(key) == Occupancy::kFree; });
}

/// Without any key twice.
inline void sort(std::vector<VoxelKey>& keys) {
  std::ranges::sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

}  // namespace frontlux::test
