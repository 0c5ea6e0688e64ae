#pragma once

#include "view/exact/window_layout.hpp"

#include <frontlux/view_region.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::detail {

/// For a voxel anywhere around a tile: which places of the tile have it in view, a bit for each. So what the
/// places have in view is counted target by target.
class PlacesInView {
 public:
  PlacesInView(const ViewRegion& view, const WindowLayout& layout);

  /// Where the bits of a voxel lie in its level. Both are offsets from the tile's first place. @pre a place
  /// of the tile has a voxel there in its reach
  [[nodiscard]] std::int32_t offset(int dx, int dy) const {
    const int from_last = last_y_ - dy;
    const int row = from_last % layout_.stride_y * run_ + from_last / layout_.stride_y;
    return static_cast<std::int32_t>(sizeof(std::uint16_t)) *
           ((dx + layout_.reach_x) * layout_.stride_y * run_ + row);
  }
  /// All voxels at a height above the tile, of at most `reach_z`.
  [[nodiscard]] const std::byte* level(int dz) const {
    return reinterpret_cast<const std::byte*>(words_.data() +
                                              static_cast<std::size_t>(dz + layout_.reach_z) * level_size_);
  }

 private:
  WindowLayout layout_;
  int last_y_;  // of all offsets to a voxel that is looked at
  int run_;     // rows that are a stride apart
  std::size_t level_size_;
  std::vector<std::uint16_t> words_;  // a row of places each; by level, dx, then dy downwards
};

}  // namespace frontlux::detail
