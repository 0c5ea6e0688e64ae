#include "corridor/erosion.hpp"

#include <algorithm>

namespace frontlux::planner::detail {

Erosion::Erosion(const KeyBox& box, const VoxelWindow& window, bool beyond)
    : window_(window), beyond_(beyond), along_z_(box, beyond), along_yz_(box, beyond), whole_(box, beyond) {}

// Renews the columns of `to` whose window along an axis meets a stale one of `from`, marking what changes.
template <int kAxis>
void Erosion::erode_across(const VoxelColumns& from, VoxelColumns& to) const {
  constexpr auto kPlace = static_cast<std::size_t>(kAxis);
  const int size_x = from.size_x(), size_y = from.size_y(), size = kAxis == 0 ? size_x : size_y;
  const int low = window_.low[kPlace], high = window_.high[kPlace];
  VoxelColumns::Flags hit(to.stale.size(), 0);
  for (int x = 0; x < size_x; ++x)
    for (int y = 0; y < size_y; ++y) {
      if (from.stale[from.flag(x, y)] == 0) continue;
      const int i = kAxis == 0 ? x : y;
      for (int k = std::max(0, i - high); k <= std::min(size - 1, i - low); ++k)
        hit[kAxis == 0 ? from.flag(k, y) : from.flag(x, k)] = 1;
    }
  for (int x = 0; x < size_x; ++x)
    for (int y = 0; y < size_y; ++y) {
      if (hit[from.flag(x, y)] == 0) continue;
      const int i = kAxis == 0 ? x : y;
      const bool fits = beyond_ || (i + low >= 0 && i + high < size);
      const int first = std::max(0, i + low), last = std::min(size - 1, i + high);
      for (std::size_t w = 0; w < from.words(); ++w) {
        std::uint64_t all = fits ? ~std::uint64_t{0} : 0;
        for (int k = first; fits && k <= last; ++k)
          all &= from.bits[(kAxis == 0 ? from.column(k, y) : from.column(x, k)) + w];
        std::uint64_t& word = to.bits[to.column(x, y) + w];
        if (word == all) continue;
        word = all;
        to.stale[to.flag(x, y)] = 1;
      }
    }
}

void Erosion::erode(const VoxelColumns& columns) {
  along_z_.stale = columns.stale;
  for (std::size_t i = 0; i < columns.stale.size(); ++i) {
    if (columns.stale[i] == 0) continue;
    const std::size_t words = columns.words();
    and_along_z(std::span(columns.bits).subspan(i * words, words), window_.low[2], window_.high[2], beyond_,
                std::span(along_z_.bits).subspan(i * words, words));
  }
  erode_across<1>(along_z_, along_yz_);
  erode_across<0>(along_yz_, whole_);
  for (VoxelColumns* done : {&along_z_, &along_yz_, &whole_}) done->settle();
}

}  // namespace frontlux::planner::detail
