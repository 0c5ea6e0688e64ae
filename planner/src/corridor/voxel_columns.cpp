#include "corridor/voxel_columns.hpp"

#include "mapping/octree_order.hpp"
#include "mapping/sort_once.hpp"

#include <algorithm>

namespace frontlux::planner::detail {
namespace {

// Transposes 8 x 8 bits: bit 8 i + j becomes bit 8 j + i.
std::uint64_t transposed(std::uint64_t bits) {
  const auto swap = [&bits](std::uint64_t mask, int distance) {
    const std::uint64_t difference = (bits ^ (bits >> distance)) & mask;
    bits ^= difference ^ (difference << distance);
  };
  swap(0x00AA00AA00AA00AA, 7);
  swap(0x0000CCCC0000CCCC, 14);
  swap(0x00000000F0F0F0F0, 28);
  return bits;
}

}  // namespace

VoxelColumns::VoxelColumns(const KeyBox& box, bool set)
    : stale(static_cast<std::size_t>(box.max.x - box.min.x + 1) *
            static_cast<std::size_t>(box.max.y - box.min.y + 1)),
      box_(box),
      base_z_(box.min.z & ~7),
      size_x_(box.max.x - box.min.x + 1),
      size_y_(box.max.y - box.min.y + 1),
      words_(static_cast<std::size_t>((box.max.z - base_z_) / 64 + 1)) {
  bits.resize(column(size_x_, 0), set ? ~std::uint64_t{0} : 0);
}

void VoxelColumns::read_brick(const VoxelGrid& grid, Occupancy state, const VoxelKey& corner) {
  const Brick& brick = grid.brick(corner);
  const auto& layers = state == Occupancy::kFree ? brick.free : brick.occupied;
  const int low_z = std::max(0, box_.min.z - corner.z), high_z = std::min(7, box_.max.z - corner.z);
  const std::uint64_t inside = (std::uint64_t{0xFF} >> (7 - high_z)) & (std::uint64_t{0xFF} << low_z);
  const int z = corner.z - base_z_;
  const std::uint64_t mask = inside << (z & 63);
  for (int y = std::max<int>(corner.y, box_.min.y); y <= std::min(corner.y + 7, int{box_.max.y}); ++y) {
    std::uint64_t rows = 0;  // byte z, bit x
    for (std::size_t layer = 0; layer < 8; ++layer)
      rows |= ((layers[layer] >> (8 * (y - corner.y))) & 0xFF) << (8 * layer);
    rows = transposed(rows);
    for (int x = std::max<int>(corner.x, box_.min.x); x <= std::min(corner.x + 7, int{box_.max.x}); ++x) {
      const std::size_t first = column(x - box_.min.x, y - box_.min.y);
      std::uint64_t& word = bits[first + static_cast<std::size_t>(z >> 6)];
      const std::uint64_t byte = (rows >> (8 * (x - corner.x))) & inside;
      const std::uint64_t renewed = (word & ~mask) | (byte << (z & 63));
      if (renewed == word) continue;
      word = renewed;
      stale.add(first / words_);
    }
  }
}

void VoxelColumns::read(const VoxelGrid& grid, Occupancy state) {
  for (int x = box_.min.x & ~7; x <= box_.max.x; x += 8)
    for (int y = box_.min.y & ~7; y <= box_.max.y; y += 8)
      for (int z = base_z_; z <= box_.max.z; z += 8) read_brick(grid, state, make_key(x, y, z));
}

void VoxelColumns::read(const VoxelGrid& grid, Occupancy state, std::span<const VoxelKey> changed) {
  std::vector<VoxelKey> corners;
  for (const VoxelKey& key : changed) {
    if (!box_.contains(key)) continue;
    const VoxelKey corner = brick_corner(key);
    if (corners.empty() || corners.back() != corner) corners.push_back(corner);
  }
  sort_once(corners);
  for (const VoxelKey& corner : corners) read_brick(grid, state, corner);
}

void and_along_z(std::span<const std::uint64_t> column, int low, int high, bool beyond,
                 std::span<std::uint64_t> to) {
  const int words = static_cast<int>(column.size());
  for (int w = 0; w < words; ++w) {
    std::uint64_t all = ~std::uint64_t{0};
    for (int d = low; d <= high; ++d) {
      // Bits 64 w + d to 64 w + d + 63 of the column.
      const int bit = w * 64 + d;
      const int word = bit >> 6, shift = bit & 63;
      const auto at = [&](int i) {
        return i < 0 || i >= words ? (beyond ? ~std::uint64_t{0} : 0) : column[static_cast<std::size_t>(i)];
      };
      all &= shift == 0 ? at(word) : (at(word) >> shift) | (at(word + 1) << (64 - shift));
    }
    to[static_cast<std::size_t>(w)] = all;
  }
}

}  // namespace frontlux::planner::detail
