#include "maps/octree.hpp"

#include "octomap/quiet_octomap.hpp"

#include <optional>
#include <sstream>
#include <string>

namespace frontlux::bench {
namespace {

constexpr int kDepth = 16;

octomap::OcTreeNode* child(octomap::OcTree& tree, octomap::OcTreeNode* node, unsigned index) {
  return tree.nodeChildExists(node, index) ? tree.getNodeChild(node, index)
                                           : tree.createNodeChild(node, index);
}

octomap::OcTreeNode* descend(octomap::OcTree& tree, const Block& block) {
  if (tree.getRoot() == nullptr) {
    // OctoMap can make a root without children only by reading one.
    std::istringstream no_children(std::string(2, '\0'));
    tree.readBinaryData(no_children);
  }
  octomap::OcTreeNode* node = tree.getRoot();
  for (int log2_edge = kDepth - 1; log2_edge >= block.log2_edge; --log2_edge) {
    const auto bit = [&](std::uint16_t key) { return (static_cast<unsigned>(key) >> log2_edge) & 1U; };
    node = child(tree, node, bit(block.corner.x) | (bit(block.corner.y) << 1U) | (bit(block.corner.z) << 2U));
  }
  return node;
}

/// The state of all voxels of a block within a brick; nothing if it is mixed.
std::optional<Occupancy> uniform_state(const Block& block, const Brick& brick) {
  const Occupancy first = brick.at(block.corner);
  const auto is_first = [&](const VoxelKey& key) { return brick.at(key) == first; };
  return all_of(cube(block.corner, 1 << block.log2_edge), is_first) ? std::optional(first) : std::nullopt;
}

/// Grows a node that stands for a block: of one state, or within a brick. @pre not all of it is unknown
void grow(octomap::OcTree& tree, octomap::OcTreeNode* node, const Block& block, const Brick* brick,
          Occupancy state) {
  if (const auto all = brick == nullptr ? std::optional(state) : uniform_state(block, *brick)) {
    node->setLogOdds(*all == Occupancy::kOccupied ? tree.getClampingThresMaxLog()
                                                  : tree.getClampingThresMinLog());
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    const Block part = octant(block, i);
    if (uniform_state(part, *brick) != Occupancy::kUnknown)
      grow(tree, child(tree, node, i), part, brick, state);
  }
}

/// From the leaves up. The tree's own `prune` stops at the first depth where nothing can be
/// pruned: here the smallest voxels of a brick are pruned already.
void prune(octomap::OcTree& tree, octomap::OcTreeNode* node) {
  if (!tree.nodeHasChildren(node)) return;
  for (unsigned i = 0; i < 8; ++i)
    if (tree.nodeChildExists(node, i)) prune(tree, tree.getNodeChild(node, i));
  tree.pruneNode(node);
}

}  // namespace

std::shared_ptr<octomap::OcTree> make_octree(const VoxelGrid& grid) {
  auto tree = std::make_shared<octomap::OcTree>(grid.resolution());
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    grow(*tree, descend(*tree, block), block, brick, state);
  });
  tree->updateInnerOccupancy();
  if (tree->getRoot() != nullptr) prune(*tree, tree->getRoot());
  return tree;
}

}  // namespace frontlux::bench
