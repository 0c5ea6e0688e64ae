#include "scaling/octree.hpp"

#include "quiet_octomap.hpp"

#include <optional>
#include <sstream>
#include <string>

namespace frontlux::bench {
namespace {

constexpr int kDepth = 16;

class Grower {
 public:
  explicit Grower(octomap::OcTree& tree) : tree_(tree) {}

  void grow(const Block& block, const Brick* brick, Occupancy state) {
    octomap::OcTreeNode* node = descend(block);
    if (brick == nullptr) {
      set(node, state);
    } else {
      grow_within(node, block, *brick);
    }
  }

 private:
  octomap::OcTreeNode* child(octomap::OcTreeNode* node, unsigned index) {
    return tree_.nodeChildExists(node, index) ? tree_.getNodeChild(node, index)
                                              : tree_.createNodeChild(node, index);
  }

  octomap::OcTreeNode* descend(const Block& block) {
    if (tree_.getRoot() == nullptr) {
      // OctoMap can make a root without children only by reading one.
      std::istringstream no_children(std::string(2, '\0'));
      tree_.readBinaryData(no_children);
    }
    octomap::OcTreeNode* node = tree_.getRoot();
    for (int log2_edge = kDepth - 1; log2_edge >= block.log2_edge; --log2_edge) {
      const auto bit = [&](std::uint16_t key) { return (static_cast<unsigned>(key) >> log2_edge) & 1U; };
      node = child(node, bit(block.corner.x) | (bit(block.corner.y) << 1U) | (bit(block.corner.z) << 2U));
    }
    return node;
  }

  void set(octomap::OcTreeNode* node, Occupancy state) {
    node->setLogOdds(state == Occupancy::kOccupied ? tree_.getClampingThresMaxLog()
                                                   : tree_.getClampingThresMinLog());
  }

  /// The state of all voxels of a block within a brick; nothing if it is mixed.
  static std::optional<Occupancy> uniform_state(const Block& block, const Brick& brick) {
    const Occupancy first = brick.at(block.corner);
    const auto is_first = [&](const VoxelKey& key) { return brick.at(key) == first; };
    return all_of(cube(block.corner, 1 << block.log2_edge), is_first) ? std::optional(first) : std::nullopt;
  }

  /// @pre not all of the block is unknown
  void grow_within(octomap::OcTreeNode* node, const Block& block, const Brick& brick) {
    if (const auto state = uniform_state(block, brick)) {
      set(node, *state);
      return;
    }
    const int log2_edge = block.log2_edge - 1;
    for (unsigned i = 0; i < 8; ++i) {
      const auto step = [&](unsigned bit) { return ((i >> bit) & 1U) << log2_edge; };
      const Block part{make_key(block.corner.x + step(0), block.corner.y + step(1), block.corner.z + step(2)),
                       log2_edge};
      if (uniform_state(part, brick) != Occupancy::kUnknown) grow_within(child(node, i), part, brick);
    }
  }

  octomap::OcTree& tree_;
};

/// From the leaves up. The tree's own `prune` stops at the first depth where nothing can be
/// pruned: here the smallest voxels of a brick are pruned already.
void prune(octomap::OcTree& tree, octomap::OcTreeNode* node) {
  if (!tree.nodeHasChildren(node)) return;
  for (unsigned i = 0; i < 8; ++i) {
    if (tree.nodeChildExists(node, i)) prune(tree, tree.getNodeChild(node, i));
  }
  tree.pruneNode(node);
}

}  // namespace

std::shared_ptr<octomap::OcTree> make_octree(const VoxelGrid& grid) {
  auto tree = std::make_shared<octomap::OcTree>(grid.resolution());
  Grower grower(*tree);
  grid.for_each_block(
      [&](const Block& block, const Brick* brick, Occupancy state) { grower.grow(block, brick, state); });
  tree->updateInnerOccupancy();
  if (tree->getRoot() != nullptr) prune(*tree, tree->getRoot());
  return tree;
}

}  // namespace frontlux::bench
