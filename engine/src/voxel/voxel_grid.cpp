#include <frontlux/file.hpp>
#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

using detail::child_corner;
using detail::kStates;
using detail::Shared;
using detail::Tile;
using detail::uniform_node;
using detail::uniform_state;

template <class Visit>
void visit_blocks(const Tile& tile, const VoxelKey& corner, const Visit& visit) {
  for (int i = 0; i < 512; ++i) {
    const auto slot = tile.slots[static_cast<std::size_t>(i)];
    if (slot == 0) continue;
    const Block block{child_corner<Brick::kLog2, 3>(corner, i), Brick::kLog2};
    if (slot < kStates.size())
      visit(block, nullptr, kStates[slot]);
    else
      visit(block, &tile.bricks[slot], Occupancy::kUnknown);
  }
}

template <class Node, class Visit>
void visit_blocks(const Node& node, const VoxelKey& corner, const Visit& visit) {
  using Child = typename Node::Child;
  for (int i = 0; i < Node::kChildren; ++i) {
    const Shared<Child>& child = node.child(i);
    if (child == uniform_node<Child>(Occupancy::kUnknown)) continue;
    const VoxelKey at = child_corner<Child::kLog2, Node::kChildBits>(corner, i);
    if (const auto state = uniform_state(child))
      visit(Block{at, Child::kLog2}, nullptr, *state);
    else
      visit_blocks(*child, at, visit);
  }
}

template <class Visit>
void visit_changes(const Tile& before, const Tile& after, const VoxelKey& corner, const Visit& visit) {
  for (int i = 0; i < 512; ++i) {
    const auto a = before.slots[static_cast<std::size_t>(i)], b = after.slots[static_cast<std::size_t>(i)];
    if (a == b && a < kStates.size()) continue;
    if (before.bricks[a] != after.bricks[b])
      visit(Block{child_corner<Brick::kLog2, 3>(corner, i), Brick::kLog2});
  }
}

template <class Node, class Visit>
void visit_changes(const Node& before, const Node& after, const VoxelKey& corner, const Visit& visit) {
  using Child = typename Node::Child;
  for (int i = 0; i < Node::kChildren; ++i) {
    const auto &a = before.child(i), &b = after.child(i);
    if (a == b) continue;
    const VoxelKey at = child_corner<Child::kLog2, Node::kChildBits>(corner, i);
    if (uniform_state(a) && uniform_state(b))
      visit(Block{at, Child::kLog2});
    else
      visit_changes(*a, *b, at, visit);
  }
}

std::size_t bytes(const Tile& tile) {
  return sizeof(Tile) + tile.bricks.capacity() * sizeof(Brick) +
         tile.unused.capacity() * sizeof(std::uint16_t);
}

template <class Node>
std::size_t bytes(const Node& node) {
  std::size_t sum = sizeof(Node) + node.nodes.capacity() * sizeof(node.nodes[0]) +
                    node.unused.capacity() * sizeof(std::uint16_t);
  for (const auto& child : node.nodes)
    if (!uniform_state(child)) sum += bytes(*child);
  return sum;
}

int low(std::uint64_t bits) { return std::countr_zero(bits); }
int high(std::uint64_t bits) { return 63 - std::countl_zero(bits); }

}  // namespace

VoxelGrid::VoxelGrid(double resolution)
    : lattice_(resolution), world_(uniform_node<detail::World>(Occupancy::kUnknown)) {}

void VoxelGrid::fill(const Block& block, Occupancy state) {
  const bool edge_fits = block.log2_edge >= 0 && block.log2_edge <= 16;
  const int misaligned =
      edge_fits ? (block.corner.x | block.corner.y | block.corner.z) & ((1 << block.log2_edge) - 1) : 1;
  if (misaligned != 0)
    throw std::invalid_argument("no aligned block of edge 2^" + std::to_string(block.log2_edge) +
                                " begins at key (" + std::to_string(block.corner.x) + ", " +
                                std::to_string(block.corner.y) + ", " + std::to_string(block.corner.z) + ")");
  if (state != Occupancy::kUnknown && state != Occupancy::kFree && state != Occupancy::kOccupied)
    throw std::invalid_argument("there is no occupancy of number " + std::to_string(static_cast<int>(state)));
  const auto& all = uniform_node<detail::World>(state);
  if (world_ == all) return;
  if (world_.own().fill(block.corner, block.log2_edge, state)) world_ = all;
}

void VoxelGrid::for_each_block(
    const std::function<void(const Block&, const Brick*, Occupancy)>& visit) const {
  visit_blocks(*world_, {}, visit);
}

std::optional<KeyBox> VoxelGrid::known_bounds() const {
  std::optional<KeyBox> box;
  const auto add = [&box](const KeyBox& known) { box = box ? hull(*box, known) : known; };
  for_each_block([&](const Block& block, const Brick* brick, Occupancy) {
    const VoxelKey& at = block.corner;
    if (brick == nullptr) {
      add(cube(at, 1 << block.log2_edge));
      return;
    }
    // What is known, projected along z, on z, and along z and y.
    std::uint64_t square = 0, layers = 0, row = 0;
    for (std::size_t z = 0; z < 8; ++z) {
      const std::uint64_t known = brick->free[z] | brick->occupied[z];
      square |= known;
      if (known != 0) layers |= std::uint64_t{1} << z;
    }
    for (int y = 0; y < 8; ++y) row |= (square >> (8 * y)) & 0xFF;
    add({make_key(at.x + low(row), at.y + low(square) / 8, at.z + low(layers)),
         make_key(at.x + high(row), at.y + high(square) / 8, at.z + high(layers))});
  });
  return box;
}

std::array<std::uint64_t, 3> VoxelGrid::count() const {
  std::array<std::uint64_t, 3> voxels{};
  for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    if (brick == nullptr) {
      voxels[static_cast<std::size_t>(state)] += std::uint64_t{1} << (3 * block.log2_edge);
      return;
    }
    for (std::size_t z = 0; z < 8; ++z) {
      voxels[1] += static_cast<std::uint64_t>(std::popcount(brick->free[z]));
      voxels[2] += static_cast<std::uint64_t>(std::popcount(brick->occupied[z]));
    }
  });
  voxels[0] = (std::uint64_t{1} << 48) - voxels[1] - voxels[2];
  return voxels;
}

std::size_t VoxelGrid::memory_bytes() const { return sizeof(*this) + bytes(*world_); }

bool operator==(const VoxelGrid& a, const VoxelGrid& b) {
  if (a.resolution() != b.resolution()) return false;
  bool equal = true;
  for_each_change(a, b, [&](const Block&) { equal = false; });
  return equal;
}

void for_each_change(const VoxelGrid& before, const VoxelGrid& after,
                     const std::function<void(const Block&)>& visit) {
  if (before.resolution() != after.resolution())
    throw std::invalid_argument("voxels of " + decimals_of(before.resolution()) + " and of " +
                                decimals_of(after.resolution()) + " m cannot be compared");
  if (before.world_ == after.world_) return;
  visit_changes(*before.world_, *after.world_, {}, visit);
}

}  // namespace frontlux
