#pragma once

#include "voxel/cell_box.hpp"
#include "view/target_index.hpp"
#include "view/exact/trie_walk.hpp"
#include "view/view_reach.hpp"
#include "view/exact/window_layout.hpp"

#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::detail {

/// What lies around tiles that stand above each other, spread out so that the walk loads it as it is: for
/// every voxel in reach of a tile's first place 16 bits, of that voxel and those that other places of the row
/// find in its stead. Voxels outside of the key range are neither free nor targets.
class ViewWindow {
 public:
  /// Looks at other tiles.
  /// @param places  voxels of all their places: lowest and highest along each axis
  void aim(const WindowLayout& layout, const CellBox& places);

  void fill_free(const VoxelGrid& grid, const TrieWalk& walk);
  /// False if there is none.
  bool fill_targets(const TargetIndex& targets, const ViewReach& reach, const TrieWalk& walk);

  /// For `TrieWalk`, of the tile at a height.
  [[nodiscard]] const std::byte* level(int z) const {
    return reinterpret_cast<const std::byte*>(spread_.data()) +
           static_cast<std::size_t>(z - places_.min[2]) * layout_.level_bytes();
  }

 private:
  [[nodiscard]] std::size_t levels() const {
    return static_cast<std::size_t>(places_.max[2] - places_.min[2] + 1 + 2 * layout_.reach_z);
  }
  // Of the byte that holds a voxel, both counted from the corner.
  struct Bit {
    std::size_t byte;
    unsigned shift;
  };
  [[nodiscard]] Bit bit(const std::array<int, 3>& from_corner) const;
  void clear_packed();
  void spread_level(std::size_t level, const TrieWalk& walk);

  WindowLayout layout_;
  CellBox places_;
  std::array<int, 3> corner_{};  // of what is packed: aligned to bricks
  std::size_t run_ = 0, bytes_across_ = 0;
  std::vector<std::uint8_t> packed_;  // by level, column modulo stride, eight columns, row modulo stride, row
  std::vector<std::uint8_t> present_;  // by level: whether a bit of it is set
  std::vector<std::uint16_t> spread_;
  std::vector<std::uint32_t> cubes_;
};

}  // namespace frontlux::detail
