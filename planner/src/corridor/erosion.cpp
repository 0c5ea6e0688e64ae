#include "corridor/erosion.hpp"

#include <algorithm>

namespace frontlux::planner::detail {

Erosion::Erosion(const KeyBox& box, const VoxelWindow& window, bool beyond)
    : window_(window), beyond_(beyond), along_(2, VoxelColumns(box, beyond)), whole_(box, beyond) {}

Erosion::Erosion(const KeyBox& box, const BodyStencil& stencil)
    : window_{stencil.low(), stencil.high()}, beyond_(false), whole_(box) {
  if (stencil.is_box()) {
    along_.assign(2, VoxelColumns(box));
    return;
  }
  for (int x = window_.low[0]; x <= window_.high[0]; ++x)
    for (int y = window_.low[1]; y <= window_.high[1]; ++y) {
      const BodyStencil::Range range = stencil.column(x, y);
      if (range.low > range.high) continue;
      auto part = std::ranges::find_if(
          parts_, [&](const Part& p) { return p.low == range.low && p.high == range.high; });
      if (part == parts_.end())
        part = parts_.insert(part, {range.low, range.high, {}, {}, VoxelColumns(box)});
      part->columns.push_back({x, y});
      const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(x) * whole_.size_y() + y;
      part->offsets.push_back(column * static_cast<std::ptrdiff_t>(whole_.words()));
    }
}

void Erosion::erode_along_z(const VoxelColumns& from, int low, int high, VoxelColumns& to) const {
  to.stale = from.stale;
  for (std::size_t i = 0; i < from.stale.size(); ++i) {
    if (from.stale[i] == 0) continue;
    const std::size_t words = from.words();
    and_along_z(std::span(from.bits).subspan(i * words, words), low, high, beyond_,
                std::span(to.bits).subspan(i * words, words));
  }
}

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

// Renews the columns whose stencil meets a stale one.
void Erosion::erode_parts() {
  const int size_x = whole_.size_x(), size_y = whole_.size_y();
  const auto inside = [&](int x, int y) { return x >= 0 && x < size_x && y >= 0 && y < size_y; };
  VoxelColumns::Flags hit(whole_.stale.size(), 0);
  for (int x = 0; x < size_x; ++x)
    for (int y = 0; y < size_y; ++y)
      for (const Part& part : parts_) {
        if (part.along_z.stale[whole_.flag(x, y)] == 0) continue;
        for (const auto& [dx, dy] : part.columns)
          if (inside(x - dx, y - dy)) hit[whole_.flag(x - dx, y - dy)] = 1;
      }
  // Where the stencil leaves the box nothing is ever set.
  const auto& [low, high] = window_;
  for (int x = -low[0]; x < size_x - high[0]; ++x)
    for (int y = -low[1]; y < size_y - high[1]; ++y) {
      if (hit[whole_.flag(x, y)] == 0) continue;
      for (std::size_t w = 0; w < whole_.words(); ++w) {
        const auto first = static_cast<std::ptrdiff_t>(whole_.column(x, y) + w);
        std::uint64_t all = ~std::uint64_t{0};
        for (const Part& part : parts_) {
          const std::uint64_t* words = part.along_z.bits.data() + first;
          for (const std::ptrdiff_t offset : part.offsets) all &= words[offset];
          if (all == 0) break;
        }
        whole_.bits[static_cast<std::size_t>(first)] = all;
      }
    }
}

void Erosion::erode(const VoxelColumns& columns) {
  if (parts_.empty()) {
    erode_along_z(columns, window_.low[2], window_.high[2], along_[0]);
    erode_across<1>(along_[0], along_[1]);
    erode_across<0>(along_[1], whole_);
  }
  for (Part& part : parts_) erode_along_z(columns, part.low, part.high, part.along_z);
  if (!parts_.empty()) erode_parts();
  for (VoxelColumns& done : along_) done.settle();
  for (Part& part : parts_) part.along_z.settle();
  whole_.settle();
}

}  // namespace frontlux::planner::detail
