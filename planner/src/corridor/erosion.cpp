#include "corridor/erosion.hpp"

#include "mapping/octree_order.hpp"

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

Erosion::Erosion(const KeyBox& box, const VoxelWindow& window)
    : box_(box),
      window_(window),
      base_z_(box.min.z & ~7),
      size_x_(box.max.x - box.min.x + 1),
      size_y_(box.max.y - box.min.y + 1),
      words_(static_cast<std::size_t>((box.max.z - base_z_) / 64 + 1)) {
  const std::size_t columns = static_cast<std::size_t>(size_x_) * static_cast<std::size_t>(size_y_);
  for (Bits* bits : {&free_, &free_z_, &free_yz_, &whole_}) bits->assign(columns * words_, 0);
  for (Flags* flags : {&stale_, &stale_yz_, &stale_xyz_}) flags->resize(columns);
}

void Erosion::read_brick(const VoxelGrid& grid, const VoxelKey& corner) {
  const Brick& brick = grid.brick(corner);
  const int low_z = std::max(0, box_.min.z - corner.z), high_z = std::min(7, box_.max.z - corner.z);
  const std::uint64_t inside = (std::uint64_t{0xFF} >> (7 - high_z)) & (std::uint64_t{0xFF} << low_z);
  const int z = corner.z - base_z_;
  const std::uint64_t byte_mask = std::uint64_t{0xFF} << (z & 63);
  for (int y = std::max<int>(corner.y, box_.min.y); y <= std::min(corner.y + 7, int{box_.max.y}); ++y) {
    std::uint64_t rows = 0;  // byte z, bit x
    for (std::size_t layer = 0; layer < 8; ++layer)
      rows |= ((brick.free[layer] >> (8 * (y - corner.y))) & 0xFF) << (8 * layer);
    rows = transposed(rows);
    for (int x = std::max<int>(corner.x, box_.min.x); x <= std::min(corner.x + 7, int{box_.max.x}); ++x) {
      const std::size_t first = column(x - box_.min.x, y - box_.min.y);
      std::uint64_t& word = free_[first + static_cast<std::size_t>(z >> 6)];
      const std::uint64_t byte = (rows >> (8 * (x - corner.x))) & inside;
      const std::uint64_t renewed = (word & ~byte_mask) | (byte << (z & 63));
      if (renewed == word) continue;
      word = renewed;
      stale_[first / words_] = 1;
    }
  }
}

void Erosion::read(const VoxelGrid& grid) {
  for (int x = box_.min.x & ~7; x <= box_.max.x; x += 8)
    for (int y = box_.min.y & ~7; y <= box_.max.y; y += 8)
      for (int z = base_z_; z <= box_.max.z; z += 8) read_brick(grid, make_key(x, y, z));
  erode();
}

void Erosion::read(const VoxelGrid& grid, std::span<const VoxelKey> changed) {
  std::vector<VoxelKey> corners;
  for (const VoxelKey& key : changed) {
    if (!box_.contains(key)) continue;
    const VoxelKey corner = brick_corner(key);
    if (corners.empty() || corners.back() != corner) corners.push_back(corner);
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  for (const VoxelKey& corner : corners) read_brick(grid, corner);
  erode();
}

void Erosion::erode_along_z(std::size_t first) {
  for (std::size_t w = 0; w < words_; ++w) {
    std::uint64_t all = ~std::uint64_t{0};
    for (int d = window_.low[2]; d <= window_.high[2]; ++d) {
      // Bits 64 w + d to 64 w + d + 63 of the column, zero beyond its ends.
      const int bit = static_cast<int>(w) * 64 + d;
      const int word = bit >> 6, shift = bit & 63;
      const auto at = [&](int i) {
        return i < 0 || i >= static_cast<int>(words_) ? 0 : free_[first + static_cast<std::size_t>(i)];
      };
      all &= shift == 0 ? at(word) : (at(word) >> shift) | (at(word + 1) << (64 - shift));
    }
    free_z_[first + w] = all;
  }
}

// Renews the columns of `to` whose window along an axis meets a stale one of `from`, marking what changes.
template <int kAxis>
void Erosion::erode_across(const Bits& from, Bits& to, const Flags& stale_from, Flags& stale_to) {
  constexpr auto kPlace = static_cast<std::size_t>(kAxis);
  const int size = kAxis == 0 ? size_x_ : size_y_, low = window_.low[kPlace], high = window_.high[kPlace];
  const auto flag = [&](int x, int y) {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(size_y_) + static_cast<std::size_t>(y);
  };
  std::vector<std::uint8_t> hit(stale_to.size(), 0);
  for (int x = 0; x < size_x_; ++x)
    for (int y = 0; y < size_y_; ++y) {
      if (stale_from[flag(x, y)] == 0) continue;
      const int i = kAxis == 0 ? x : y;
      for (int k = std::max(0, i - high); k <= std::min(size - 1, i - low); ++k)
        hit[kAxis == 0 ? flag(k, y) : flag(x, k)] = 1;
    }
  for (int x = 0; x < size_x_; ++x)
    for (int y = 0; y < size_y_; ++y) {
      if (hit[flag(x, y)] == 0) continue;
      const int i = kAxis == 0 ? x : y;
      const bool fits = i + low >= 0 && i + high < size;
      for (std::size_t w = 0; w < words_; ++w) {
        std::uint64_t all = fits ? ~std::uint64_t{0} : 0;
        for (int k = i + low; fits && k <= i + high; ++k)
          all &= from[(kAxis == 0 ? column(k, y) : column(x, k)) + w];
        std::uint64_t& word = to[column(x, y) + w];
        if (word == all) continue;
        word = all;
        stale_to[flag(x, y)] = 1;
      }
    }
}

void Erosion::erode() {
  for (std::size_t i = 0; i < stale_.size(); ++i)
    if (stale_[i] != 0) erode_along_z(i * words_);
  erode_across<1>(free_z_, free_yz_, stale_, stale_yz_);
  erode_across<0>(free_yz_, whole_, stale_yz_, stale_xyz_);
  for (Flags* flags : {&stale_, &stale_yz_, &stale_xyz_}) std::fill(flags->begin(), flags->end(), 0);
}

}  // namespace frontlux::planner::detail
