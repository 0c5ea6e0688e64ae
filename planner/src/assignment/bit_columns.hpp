#pragma once

#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// A set of voxels in a box as columns of bits along z. 64 voxels can be read at a time, from any height:
/// upwards or, if the columns are built so, downwards.
class BitColumns {
 public:
  /// Bytes that a box takes.
  [[nodiscard]] static std::uint64_t bytes(const KeyBox& box) {
    return size(box.min.x, box.max.x) * size(box.min.y, box.max.y) * words(box) * sizeof(std::uint64_t);
  }

  explicit BitColumns(const KeyBox& box, bool downwards = false)
      : box_(box),
        downwards_(downwards),
        words_(words(box)),
        row_(size(box.min.y, box.max.y) * words_),
        bits_(size(box.min.x, box.max.x) * row_, 0) {}

  [[nodiscard]] const KeyBox& box() const { return box_; }

  /// @pre the key lies in the box
  void add(const VoxelKey& key) {
    const std::size_t place = height(key.z);
    bits_[column(key) + (place >> 6)] |= std::uint64_t{1} << (place & 63);
  }

  /// Adds the occupied voxels of a map.
  void add_occupied(const VoxelGrid& grid) {
    grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
      if (brick == nullptr) {
        const auto part = intersection(box_, cube(block.corner, 1 << block.log2_edge));
        if (part && state == Occupancy::kOccupied)
          for_each_key(*part, [this](const VoxelKey& key) { add(key); });
        return;
      }
      const VoxelKey& corner = block.corner;
      for (int z = 0; z < 8; ++z)
        for (std::uint64_t layer = brick->occupied[static_cast<std::size_t>(z)]; layer != 0;
             layer &= layer - 1) {
          const int bit = std::countr_zero(layer);
          const VoxelKey key = make_key(corner.x + (bit & 7), corner.y + (bit >> 3), corner.z + z);
          if (box_.contains(key)) add(key);
        }
    });
  }

  /// Words from a column to the next one along x, and along y.
  [[nodiscard]] std::ptrdiff_t along_x() const { return static_cast<std::ptrdiff_t>(row_); }
  [[nodiscard]] std::ptrdiff_t along_y() const { return static_cast<std::ptrdiff_t>(words_); }

  /// Where a key's column is read from its height on, and by how much it is then shifted.
  [[nodiscard]] const std::uint64_t* at(const VoxelKey& key) const {
    return &bits_[column(key) + (height(key.z) >> 6)];
  }
  [[nodiscard]] int shift(const VoxelKey& key) const { return static_cast<int>(height(key.z) & 63); }

  /// Bit k is the voxel k farther. There is none beyond the box.
  [[nodiscard]] static std::uint64_t read(const std::uint64_t* word, int shift) {
    return word[0] >> shift | (word[1] << 1) << (63 - shift);
  }

  /// Bits 0 to `last`, at most all 64.
  [[nodiscard]] static std::uint64_t bits_to(int last) {
    return last < 0 ? 0 : ~std::uint64_t{0} >> (63 - std::min(last, 63));
  }

 private:
  static std::uint64_t size(int low, int high) { return static_cast<std::uint64_t>(high - low + 1); }
  // Words of a column; the last one is empty.
  static std::uint64_t words(const KeyBox& box) { return (size(box.min.z, box.max.z) + 63) / 64 + 1; }

  [[nodiscard]] std::size_t height(int z) const {
    return static_cast<std::size_t>(downwards_ ? box_.max.z - z : z - box_.min.z);
  }
  [[nodiscard]] std::size_t column(const VoxelKey& key) const {
    return static_cast<std::size_t>(key.x - box_.min.x) * row_ +
           static_cast<std::size_t>(key.y - box_.min.y) * words_;
  }

  KeyBox box_;
  bool downwards_;
  std::uint64_t words_, row_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace frontlux::planner::detail
