#pragma once

#include "support/test.hpp"

#include <frontlux/voxel_grid.hpp>

#include <octomap/OcTreeKey.h>

namespace frontlux::test {

inline octomap::OcTreeKey tree_key(const VoxelKey& key) { return {key.x, key.y, key.z}; }

/// By the search of the tree itself.
template <class Tree>
Occupancy state_of(const Tree& tree, const octomap::OcTreeKey& key) {
  const auto* node = tree.search(key);
  if (node == nullptr) return Occupancy::kUnknown;
  return tree.isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree;
}
template <class Tree>
Occupancy state_of(const Tree& tree, const VoxelKey& key) {
  return state_of(tree, tree_key(key));
}

/// A node as an .ot file holds it.
inline std::string full_record(float log_odds, int child_mask) {
  std::string record(4, '\0');
  std::memcpy(record.data(), &log_odds, 4);
  return record + static_cast<char>(child_mask);
}

}  // namespace frontlux::test
