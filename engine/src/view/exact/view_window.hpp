#pragma once

#include "view/exact/trie_walk.hpp"
#include "view/exact/window_layout.hpp"
#include "view/target_index.hpp"

#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::detail {

/// What lies around tiles that stand above each other, spread out for the walk: 16 bits for every voxel in
/// reach of a tile's first place, one for that voxel and one for each voxel that the other places of the row
/// find at the same offset. Voxels outside of the key range are neither free nor targets.
class ViewWindow {
 public:
  /// Looks at other tiles.
  /// @param first_place  voxel of the lowest tile's first place
  /// @param top          height of the highest tile
  void aim(const WindowLayout& layout, const std::array<int, 3>& first_place, int top);

  void fill_free(const VoxelGrid& grid, const TrieWalk& walk);
  /// Lists the targets, too.
  void fill_targets(const TargetIndex& targets, const ViewRegion& view, const TrieWalk& walk,
                    std::vector<VoxelKey>& list);

  /// For `TrieWalk`, of the tile at a height.
  [[nodiscard]] const std::byte* level(int z) const {
    return reinterpret_cast<const std::byte*>(spread_.data()) +
           static_cast<std::size_t>(z - layout_.reach_z - low_[2]) * layout_.level_bytes();
  }

 private:
  [[nodiscard]] std::size_t levels() const { return static_cast<std::size_t>(high_[2] - low_[2] + 1); }
  // Of the byte that holds a voxel, both counted from the corner.
  struct Bit {
    std::size_t byte;
    unsigned shift;
  };
  [[nodiscard]] Bit bit(const std::array<int, 3>& from_corner) const;
  void clear_packed();
  void spread_level(std::size_t level, const TrieWalk& walk);

  WindowLayout layout_;
  std::array<int, 3> low_{},
      high_{};                   // of all voxels in reach of a place; some may lie outside of the key range
  std::array<int, 3> corner_{};  // of what is packed: aligned to bricks
  std::size_t run_ = 0, bytes_across_ = 0;
  std::vector<std::uint8_t> packed_;  // by level, column modulo stride, eight columns, row modulo stride, row
  std::vector<std::uint8_t> present_;  // by level: whether a bit of it is set
  std::vector<std::uint16_t> spread_;
  std::vector<std::uint32_t> cubes_;
};

}  // namespace frontlux::detail
