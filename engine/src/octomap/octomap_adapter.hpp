#pragma once

#include "octomap/quiet_octomap.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/ray.hpp>

#include <Eigen/Core>

#include <memory>
#include <stdexcept>
#include <variant>

namespace frontlux::detail {

inline octomap::point3d to_octomap(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }
inline Eigen::Vector3f from_octomap(const octomap::point3d& p) { return {p.x(), p.y(), p.z()}; }
inline octomap::OcTreeKey to_octomap(const VoxelKey& key) { return {key.x, key.y, key.z}; }
inline VoxelKey from_octomap(const octomap::OcTreeKey& key) { return {key[0], key[1], key[2]}; }

/// @param node  of that tree; null for a voxel that has none
template <class Tree>
Occupancy state_of(const Tree& tree, const typename Tree::NodeType* node) {
  if (node == nullptr) return Occupancy::kUnknown;
  return tree.isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree;
}
template <class Tree>
Occupancy state_at(const Tree& tree, const VoxelKey& key) {
  return state_of(tree, tree.search(detail::to_octomap(key)));
}

/// A tree of either kind, to be read.
using OctreePointer =
    std::variant<std::shared_ptr<const octomap::OcTree>, std::shared_ptr<const octomap::ColorOcTree>>;

/// A pointer to a tree that somebody else owns.
template <class Tree>
std::shared_ptr<Tree> borrowed(Tree& tree) {
  return {std::shared_ptr<void>(), &tree};
}

/// @throws std::invalid_argument if there is none
template <class Pointer>
const Pointer& there(const Pointer& tree) {
  if (tree == nullptr) throw std::invalid_argument("an Octree without a tree: read or make one first");
  return tree;
}

inline OctreePointer to_read(const Octree& tree) {
  return std::visit([](const auto& t) { return OctreePointer(there(t)); }, tree);
}

}  // namespace frontlux::detail
