#include "octomap/octomap_adapter.hpp"

#include <frontlux/floating_point_mode.hpp>
#include <frontlux/octomap.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace frontlux {
namespace {

using detail::state_at;
using detail::state_of;

template <class Tree>
void mirror_node(const Tree& tree, const typename Tree::NodeType* node, const Block& block, VoxelGrid& grid) {
  if (block.log2_edge == 0 || !tree.nodeHasChildren(node)) {
    grid.fill(block, state_of(tree, node));
    return;
  }
  for (unsigned i = 0; i < 8; ++i)
    if (tree.nodeChildExists(node, i)) mirror_node(tree, tree.getNodeChild(node, i), octant(block, i), grid);
}

template <class Tree>
VoxelGrid mirror(const Tree& tree) {
  if (tree.getTreeDepth() != 16)
    throw std::invalid_argument(
        "only trees of OctoMap's standard depth 16 are supported, this one has depth " +
        std::to_string(tree.getTreeDepth()));
  const FloatingPointMode mode(FloatingPointMode::kToNearest);
  VoxelGrid grid(tree.getResolution());
  if (tree.getRoot() != nullptr) mirror_node(tree, tree.getRoot(), {{}, 16}, grid);
  return grid;
}

// What a storage node of this edge and its place in its parent take, or more. Lists grow by half.
std::size_t node_bytes(int log2_edge) {
  const auto with_list = [](std::size_t node, std::size_t element) {
    return node + detail::kStates.size() * element + sizeof(void*) * 3 / 2;
  };
  switch (log2_edge) {
    case Brick::kLog2:
      return sizeof(Brick) * 3 / 2;
    case detail::Tile::kLog2:
      return with_list(sizeof(detail::Tile), sizeof(Brick));
    case detail::Region::kLog2:
      return with_list(sizeof(detail::Region), sizeof(void*));
    case detail::Sector::kLog2:
      return with_list(sizeof(detail::Sector), sizeof(void*));
    case detail::World::kLog2:
      return sizeof(VoxelGrid) + with_list(sizeof(detail::World), sizeof(void*));
    default:
      return 0;
  }
}

// Only what is no leaf has a node of its own.
template <class Tree>
std::size_t mirror_bytes(const Tree& tree, const typename Tree::NodeType* node, int log2_edge) {
  std::size_t bytes = node_bytes(log2_edge);
  if (log2_edge > Brick::kLog2)
    for (unsigned i = 0; i < 8; ++i)
      if (tree.nodeChildExists(node, i) && tree.nodeHasChildren(tree.getNodeChild(node, i)))
        bytes += mirror_bytes(tree, tree.getNodeChild(node, i), log2_edge - 1);
  return bytes;
}

template <class... Trees>
VoxelGrid mirror(const std::variant<Trees...>& tree) {
  return std::visit([](const auto& t) { return mirror(*detail::there(t)); }, tree);
}

}  // namespace

VoxelGrid make_voxel_grid(const octomap::OcTree& tree) { return mirror(tree); }
VoxelGrid make_voxel_grid(const octomap::ColorOcTree& tree) { return mirror(tree); }
VoxelGrid make_voxel_grid(const Octree& tree) { return mirror(tree); }

std::size_t voxel_grid_bytes(const Octree& tree) {
  return std::visit(
      [](const auto& t) {
        return detail::there(t)->getRoot() == nullptr ? node_bytes(detail::World::kLog2)
                                                      : mirror_bytes(*t, t->getRoot(), detail::World::kLog2);
      },
      tree);
}

struct OctreeMirror::Watch {
  detail::OctreePointer tree;
  VoxelGrid grid;
  bool detecting = false;
  const void* root = nullptr;
  double occupancy_threshold = 0.0;
  // Keys that changed before: one that changes back leaves the tree's list of changes, so all are read once
  // more.
  std::vector<VoxelKey> reported{};

  explicit Watch(detail::OctreePointer watched) : tree(std::move(watched)), grid(mirror(tree)) { remember(); }

  void remember() {
    std::visit(
        [this](const auto& t) {
          detecting = t->isChangeDetectionEnabled();
          root = t->getRoot();
          occupancy_threshold = static_cast<double>(t->getOccupancyThresLog());
        },
        tree);
  }

  [[nodiscard]] bool changes_are_complete() const {
    return std::visit(
        [this](const auto& t) {
          return detecting && t->isChangeDetectionEnabled() && root != nullptr && root == t->getRoot() &&
                 occupancy_threshold == static_cast<double>(t->getOccupancyThresLog()) &&
                 grid.resolution() == t->getResolution();
        },
        tree);
  }

  void rebuild() {
    grid = mirror(tree);
    reported.clear();
    remember();
  }

  void update() {
    const FloatingPointMode mode(FloatingPointMode::kToNearest);
    std::visit(
        [this](const auto& t) {
          const auto refresh = [&](const VoxelKey& key) { grid.set(key, state_at(*t, key)); };
          for (const VoxelKey& key : reported) refresh(key);
          reported.clear();
          for (auto it = t->changedKeysBegin(); it != t->changedKeysEnd(); ++it)
            reported.push_back(detail::from_octomap(it->first));
          std::sort(reported.begin(), reported.end());
          for (const VoxelKey& key : reported) refresh(key);
        },
        tree);
    remember();
  }
};

OctreeMirror::OctreeMirror(const octomap::OcTree& tree)
    : watch_(std::make_unique<Watch>(detail::borrowed(tree))) {}
OctreeMirror::OctreeMirror(const octomap::ColorOcTree& tree)
    : watch_(std::make_unique<Watch>(detail::borrowed(tree))) {}
OctreeMirror::OctreeMirror(const Octree& tree) : watch_(std::make_unique<Watch>(detail::to_read(tree))) {}
OctreeMirror::~OctreeMirror() = default;
OctreeMirror::OctreeMirror(OctreeMirror&&) noexcept = default;
OctreeMirror& OctreeMirror::operator=(OctreeMirror&&) noexcept = default;

const VoxelGrid& OctreeMirror::grid() const { return watch_->grid; }

bool OctreeMirror::update() {
  const bool incremental = watch_->changes_are_complete();
  if (incremental)
    watch_->update();
  else
    watch_->rebuild();
  return incremental;
}

void OctreeMirror::rebuild() { watch_->rebuild(); }

}  // namespace frontlux
