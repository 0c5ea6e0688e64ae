#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// Walls and cells in a box as columns of bits, of which 64 at a time can be read from any height: upwards,
/// and in a second object downwards.
class VoxelColumns {
 public:
  enum class Kind : std::uint8_t { kWall, kCell };

  /// Bytes that a box takes.
  [[nodiscard]] static std::uint64_t bytes(const KeyBox& box) {
    return size(box.min.x, box.max.x) * size(box.min.y, box.max.y) * 2 * part(box) * sizeof(std::uint64_t);
  }

  VoxelColumns(const KeyBox& box, bool downwards)
      : box_(box),
        downwards_(downwards),
        part_(part(box)),
        row_(size(box.min.y, box.max.y) * 2 * part_),
        bits_(size(box.min.x, box.max.x) * row_, 0) {}

  [[nodiscard]] const KeyBox& box() const { return box_; }

  /// @pre the key lies in the box
  void add(Kind kind, const VoxelKey& key) {
    const std::size_t place = height(key.z);
    bits_[column(key) + (kind == Kind::kWall ? 0 : part_) + (place >> 6)] |= std::uint64_t{1} << (place & 63);
  }

  /// Words from a column to the next one along x; along y; and from the walls of a column to its cells.
  [[nodiscard]] std::ptrdiff_t along_x() const { return static_cast<std::ptrdiff_t>(row_); }
  [[nodiscard]] std::ptrdiff_t along_y() const { return static_cast<std::ptrdiff_t>(2 * part_); }
  [[nodiscard]] std::ptrdiff_t to_cells() const { return static_cast<std::ptrdiff_t>(part_); }

  /// Where the walls of a key's column are read from its height on, and by how much they are then shifted.
  [[nodiscard]] const std::uint64_t* at(const VoxelKey& key) const {
    return &bits_[column(key) + (height(key.z) >> 6)];
  }
  [[nodiscard]] int shift(const VoxelKey& key) const { return static_cast<int>(height(key.z) & 63); }

  /// Bit k is the voxel k farther. There is none beyond the box.
  [[nodiscard]] static std::uint64_t read(const std::uint64_t* word, int shift) {
    return word[0] >> shift | (word[1] << 1) << (63 - shift);
  }

 private:
  static std::uint64_t size(int low, int high) { return static_cast<std::uint64_t>(high - low + 1); }
  // Words of walls or cells in a column; the last one is empty.
  static std::uint64_t part(const KeyBox& box) { return (size(box.min.z, box.max.z) + 63) / 64 + 1; }

  [[nodiscard]] std::size_t height(int z) const {
    return static_cast<std::size_t>(downwards_ ? box_.max.z - z : z - box_.min.z);
  }
  [[nodiscard]] std::size_t column(const VoxelKey& key) const {
    return static_cast<std::size_t>(key.x - box_.min.x) * row_ +
           static_cast<std::size_t>(key.y - box_.min.y) * 2 * part_;
  }

  KeyBox box_;
  bool downwards_;
  std::uint64_t part_, row_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace frontlux::planner::detail
