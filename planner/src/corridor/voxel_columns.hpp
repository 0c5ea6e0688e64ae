#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// Some of the columns of a box, by their numbers.
class ColumnSet {
 public:
  /// @param columns  of the box
  explicit ColumnSet(std::size_t columns) : contained_(columns, 0) {}

  void add(std::size_t column) {
    if (std::exchange(contained_[column], std::uint8_t{1}) == 0)
      numbers_.push_back(static_cast<std::uint32_t>(column));
  }
  /// In the order in which they were added.
  [[nodiscard]] std::span<const std::uint32_t> numbers() const { return numbers_; }
  /// Takes as long as there are columns in the set, and gives their memory back.
  void clear() {
    for (const std::uint32_t column : std::exchange(numbers_, {})) contained_[column] = 0;
  }

 private:
  std::vector<std::uint8_t> contained_;
  std::vector<std::uint32_t> numbers_;
};

/// Some voxels of a box, as a column of bits along z for each x and y. Columns are numbered by x, then y.
class VoxelColumns {
 public:
  using Bits = std::vector<std::uint64_t>;

  /// @param set  whether voxels are set at first, and those beyond the box for ever
  explicit VoxelColumns(const KeyBox& box, bool set = false);

  /// Takes the voxels with a state, free or occupied; of a changed map those of the bricks that hold a
  /// changed voxel.
  void read(const VoxelGrid& grid, Occupancy state);
  void read(const VoxelGrid& grid, Occupancy state, std::span<const VoxelKey> changed);

  /// No column is stale any more.
  void clear_stale() { stale.clear(); }

  [[nodiscard]] const KeyBox& box() const { return box_; }
  [[nodiscard]] int size_x() const { return size_x_; }
  [[nodiscard]] int size_y() const { return size_y_; }
  /// Of a column.
  [[nodiscard]] std::size_t words() const { return words_; }
  [[nodiscard]] std::size_t column_count() const { return bits.size() / words_; }
  /// The number of a column, counted from the box's corner; the column has to be in the box.
  [[nodiscard]] std::size_t number(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(size_y_) + static_cast<std::size_t>(y);
  }
  /// Its x and y.
  [[nodiscard]] std::pair<int, int> place(std::size_t number) const {
    const auto size_y = static_cast<std::size_t>(size_y_);
    return {static_cast<int>(number / size_y), static_cast<int>(number % size_y)};
  }
  [[nodiscard]] bool has_column(int x, int y) const { return x >= 0 && x < size_x_ && y >= 0 && y < size_y_; }
  /// Its first word in `bits`.
  [[nodiscard]] std::size_t column(int x, int y) const { return number(x, y) * words_; }
  [[nodiscard]] bool holds(const VoxelKey& key) const {
    if (!box_.contains(key)) return false;
    const int z = key.z - base_z_;
    const std::size_t first = column(key.x - box_.min.x, key.y - box_.min.y);
    return ((bits[first + static_cast<std::size_t>(z >> 6)] >> (z & 63)) & 1U) != 0;
  }

  /// The first word of the column with a key's x and y, and the bit in it that counts from there on upwards.
  /// @pre the key is in the box
  [[nodiscard]] std::pair<std::size_t, unsigned> place_of(const VoxelKey& key) const {
    return {column(key.x - box_.min.x, key.y - box_.min.y), static_cast<unsigned>(key.z - base_z_)};
  }

  Bits bits;
  ColumnSet stale;  ///< columns that have changed

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
