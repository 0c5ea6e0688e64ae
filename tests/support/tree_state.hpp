#pragma once

#include "support/test.hpp"

#include <frontlux/voxel_grid.hpp>

#include <octomap/OcTreeKey.h>

namespace frontlux::test {

/// Whether OctoMap finds out by itself if a point has a key. On 64-bit ARM it takes a coordinate that is not
/// a number for 0, and castRay from there may never return (docs/ray_contract.md, section 6).
inline bool octomap_knows_key(const Eigen::Vector3f& point) {
#ifdef __aarch64__
  return !point.array().isNaN().any();
#else
  static_cast<void>(point);
  return true;
#endif
}

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
