#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Some voxels of a box, as a column of bits along z for each x and y.
class VoxelColumns {
 public:
  using Bits = std::vector<std::uint64_t>;
  using Flags = std::vector<std::uint8_t>;  ///< one for each column

  /// @param set  whether voxels are set at first, and those beyond the box for ever
  explicit VoxelColumns(const KeyBox& box, bool set = false);

  /// Takes the voxels with a state, free or occupied; of a changed map those of the bricks that hold a
  /// changed voxel.
  void read(const VoxelGrid& grid, Occupancy state);
  void read(const VoxelGrid& grid, Occupancy state, std::span<const VoxelKey> changed);

  /// No column is stale any more.
  void settle() { stale.assign(stale.size(), 0); }

  [[nodiscard]] const KeyBox& box() const { return box_; }
  [[nodiscard]] int size_x() const { return size_x_; }
  [[nodiscard]] int size_y() const { return size_y_; }
  /// Of a column.
  [[nodiscard]] std::size_t words() const { return words_; }
  /// Where a column begins, counted from the box's corner.
  [[nodiscard]] std::size_t column(int x, int y) const { return flag(x, y) * words_; }
  [[nodiscard]] std::size_t flag(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(size_y_) + static_cast<std::size_t>(y);
  }
  [[nodiscard]] bool holds(const VoxelKey& key) const {
    if (!box_.contains(key)) return false;
    const int z = key.z - base_z_;
    const std::size_t first = column(key.x - box_.min.x, key.y - box_.min.y);
    return ((bits[first + static_cast<std::size_t>(z >> 6)] >> (z & 63)) & 1U) != 0;
  }

  Bits bits;
  Flags stale;  ///< columns that have changed

 private:
  void read_brick(const VoxelGrid& grid, Occupancy state, const VoxelKey& corner);

  KeyBox box_;
  int base_z_, size_x_, size_y_;
  std::size_t words_;
};

/// A bit of each word of a column is set if all bits from so far below it to so far above it are.
/// @param beyond  whether bits beyond the column's ends count as set
void and_along_z(std::span<const std::uint64_t> column, int low, int high, bool beyond,
                 std::span<std::uint64_t> to);

}  // namespace frontlux::planner::detail
