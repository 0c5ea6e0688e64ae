#pragma once

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace frontlux::detail {

/// Whether a block of `for_each_change` became unknown as a whole: it may be far larger than what was known.
[[nodiscard]] inline bool is_forgotten(const Block& block, const VoxelGrid& after) {
  return block.log2_edge > Brick::kLog2 && after.at(block.corner) == Occupancy::kUnknown;
}

/// The voxels that do not block, one bit each, in a flat table around all known voxels of a map, or around
/// those in a window: packets of rays walk through it (packet_walk.hpp).
///
/// The bits lie brick by brick, so that a walk in any direction stays in a cache line for some steps. The
/// place of a voxel's bit is its index: 3 bits each of x, y and z in the brick, then the rest of x, y and z.
/// To step along an axis is to add one to that axis' bits of the index. The table ends with a border of
/// closed bricks: it stops every walk, and is wide enough for seven steps too many. There is room for more
/// than is known, so that the table can follow a map that grows.
class OpenVoxels {
 public:
  /// Of the voxels in a window. Empty if no voxel is known, or if the table would be larger than it is worth.
  /// @param known   a box of all known voxels of the map; none if there are none
  /// @param window  of whole bricks
  OpenVoxels(const VoxelGrid& grid, UnknownPolicy unknown, const std::optional<KeyBox>& known,
             const KeyBox& window);

  /// Makes it the table of `after`, where it is that of `before`.
  /// @return false if what is known has outgrown it; then another one has to be made
  [[nodiscard]] bool update(const VoxelGrid& before, const VoxelGrid& after);

  [[nodiscard]] bool empty() const { return words_ == nullptr; }
  /// True for the known voxels in the window and the rest of their bricks.
  [[nodiscard]] bool contains(const VoxelKey& key) const { return words_ && bounds_.contains(key); }

  /// What `contains` is true for, unless it is empty. The map knows nothing beyond that is in the window.
  [[nodiscard]] const KeyBox& bounds() const { return bounds_; }
  [[nodiscard]] const KeyBox& window() const { return window_; }
  /// The lowest and highest key along an axis of what `contains` is true for.
  [[nodiscard]] int bounds_min(std::size_t axis) const {
    return std::array{bounds_.min.x, bounds_.min.y, bounds_.min.z}[axis];
  }
  [[nodiscard]] int bounds_max(std::size_t axis) const {
    return std::array{bounds_.max.x, bounds_.max.y, bounds_.max.z}[axis];
  }

  /// How an index is put together.
  struct Layout {
    std::array<int, 3> corner{};             ///< key of index 0: in the border, perhaps below the key range
    std::uint32_t y_shift = 0, z_shift = 0;  ///< of what is above the brick; x has 9
    std::array<std::uint32_t, 3> bits{};     ///< that belong to each axis

    /// Of the lowest bit of what is above the brick, on an axis.
    [[nodiscard]] std::uint32_t shift(std::size_t axis) const {
      return axis == 0 ? 9U : axis == 1 ? y_shift : z_shift;
    }
    /// @pre the key lies in the table
    [[nodiscard]] std::uint32_t index(const VoxelKey& key) const {
      const auto x = static_cast<std::uint32_t>(key.x - corner[0]);
      const auto y = static_cast<std::uint32_t>(key.y - corner[1]);
      const auto z = static_cast<std::uint32_t>(key.z - corner[2]);
      return (x & 7U) | (y & 7U) << 3U | (z & 7U) << 6U | (x >> 3U) << 9U | (y >> 3U) << y_shift |
             (z >> 3U) << z_shift;
    }
    /// In the border perhaps outside the key range.
    [[nodiscard]] std::array<int, 3> key(std::uint32_t index) const {
      const std::uint32_t x = (index & bits[0] & ~511U) >> 9U, y = (index & bits[1] & ~511U) >> y_shift;
      const std::uint32_t z = index >> z_shift;
      return {corner[0] + static_cast<int>(x << 3U | (index & 7U)),
              corner[1] + static_cast<int>(y << 3U | (index >> 3U & 7U)),
              corner[2] + static_cast<int>(z << 3U | (index >> 6U & 7U))};
    }
  };
  [[nodiscard]] const Layout& layout() const { return layout_; }
  [[nodiscard]] const std::uint64_t* words() const { return words_.get(); }
  /// The highest index.
  [[nodiscard]] std::uint32_t last() const { return static_cast<std::uint32_t>(64 * word_count_ - 1); }
  [[nodiscard]] bool open(std::uint32_t index) const {
    return ((words_[index >> 6U] >> (index & 63U)) & 1U) != 0;
  }
  /// How far it is open around each cell of 4 x 4 x 4 voxels: a word for each brick, in the order of the
  /// bricks in `words`, with 4 bits for each of its 2 x 2 x 2 cells, x first. 0: the cell is not open, r:
  /// neither it nor any cell less than r cells away, along each axis, holds a closed voxel.
  [[nodiscard]] const std::uint32_t* radii() const { return radii_.data(); }
  /// That of the cell of a voxel.
  [[nodiscard]] std::uint32_t radius(std::uint32_t index) const {
    return radii_[index >> 9U] >> ((index & 4U) | (index >> 2U & 8U) | (index >> 4U & 16U)) & 15U;
  }
  /// Of what is written to; the system gives no memory for the rest.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  [[nodiscard]] bool has_room_for(const KeyBox& bounds) const;
  void write_bricks(const VoxelGrid& grid, const KeyBox& box);
  void measure_radii(const KeyBox& changed);

  struct Release {
    void operator()(std::uint64_t* words) const;
  };
  UnknownPolicy unknown_;
  KeyBox window_;
  KeyBox known_;   // bricks around all that the map knows
  KeyBox bounds_;  // those of them in the window
  Layout layout_;
  std::array<std::size_t, 3> bricks_{};  // with the border
  std::size_t word_count_ = 0;
  std::unique_ptr<std::uint64_t[], Release> words_;
  std::vector<std::uint32_t> radii_;
};

}  // namespace frontlux::detail
