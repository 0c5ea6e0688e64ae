#include <frontlux/key_box.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

class KeyList {
 public:
  // All voxels of a block.
  void add(const Block& block) {
    need(std::uint64_t{1} << (3 * block.log2_edge));
    for_each_key(cube(block.corner, 1 << block.log2_edge),
                 [&](const VoxelKey& key) { keys_.push_back(key); });
  }

  // Those of a layer of the brick that begins at a corner.
  void add(const VoxelKey& corner, std::size_t z, std::uint64_t layer) {
    need(static_cast<std::uint64_t>(std::popcount(layer)));
    for (; layer != 0; layer &= layer - 1) {
      const int bit = std::countr_zero(layer);
      keys_.push_back(make_key(corner.x + (bit & 7), corner.y + (bit >> 3), corner.z + static_cast<int>(z)));
    }
  }

  std::vector<VoxelKey> sorted() && {
    std::sort(keys_.begin(), keys_.end());
    return std::move(keys_);
  }

 private:
  // Before more are added.
  void need(std::uint64_t more) const {
    if (more > kMostListedKeys - std::min<std::uint64_t>(keys_.size(), kMostListedKeys))
      throw std::length_error("more than " + std::to_string(kMostListedKeys) + " voxels to list");
  }

  std::vector<VoxelKey> keys_;
};

}  // namespace

std::vector<VoxelKey> keys_in(const VoxelGrid& grid, Occupancy state) {
  if (state != Occupancy::kFree && state != Occupancy::kOccupied)
    throw std::invalid_argument("only free or occupied voxels can be listed");
  KeyList keys;
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy of_all) {
    if (brick != nullptr) {
      const auto& layers = state == Occupancy::kFree ? brick->free : brick->occupied;
      for (std::size_t z = 0; z < 8; ++z) keys.add(block.corner, z, layers[z]);
    } else if (of_all == state) {
      keys.add(block);
    }
  });
  return std::move(keys).sorted();
}

std::vector<VoxelKey> changed_keys(const VoxelGrid& before, const VoxelGrid& after) {
  KeyList keys;
  for_each_change(before, after, [&](const Block& block) {
    if (block.log2_edge > Brick::kLog2) return keys.add(block);  // of one state before, and of another now
    const Brick &a = before.brick(block.corner), &b = after.brick(block.corner);
    for (std::size_t z = 0; z < 8; ++z)
      keys.add(block.corner, z, (a.free[z] ^ b.free[z]) | (a.occupied[z] ^ b.occupied[z]));
  });
  return std::move(keys).sorted();
}

}  // namespace frontlux
