#include "view/exact/places_in_view.hpp"

#include <frontlux/parallel.hpp>

#include <cstdlib>

namespace frontlux::detail {

PlacesInView::PlacesInView(const ViewRegion& view, const WindowLayout& layout)
    : layout_(layout),
      last_y_(layout.reach_y + (ViewTile::kRows - 1) * layout.stride_y),
      run_(2 * last_y_ / layout.stride_y + 1) {
  const int across = 2 * layout.reach_x + 1 + (ViewTile::kColumns - 1) * layout.stride_x;
  const int levels = 2 * layout.reach_z + 1;
  level_size_ = static_cast<std::size_t>(across) * static_cast<std::size_t>(layout.stride_y * run_);
  words_.resize(static_cast<std::size_t>(levels) * level_size_);
  for_each_index(static_cast<std::size_t>(across), [&](std::size_t column) {
    const int dx = static_cast<int>(column) - layout.reach_x;
    for (int dy = -layout.reach_y; dy <= layout.reach_y; ++dy) {
      std::uint16_t* const word = words_.data() + static_cast<std::size_t>(offset(dx, dy)) / sizeof(*word);
      for (int place = 0; place < ViewTile::kColumns; ++place) {
        const int height = view.height(dx - place * layout.stride_x, dy);
        for (int dz = -height; dz <= height; ++dz) {
          std::uint16_t& there = word[static_cast<std::size_t>(dz + layout.reach_z) * level_size_];
          there = static_cast<std::uint16_t>(there | 1U << static_cast<unsigned>(place));
        }
      }
    }
  });
}

}  // namespace frontlux::detail
