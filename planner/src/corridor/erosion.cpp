#include "corridor/erosion.hpp"

#include <algorithm>

namespace frontlux::planner::detail {

Erosion::Erosion(const KeyBox& box, const VoxelWindow& window, bool beyond)
    : window_(window),
      beyond_(beyond),
      along_(2, VoxelColumns(box, beyond)),
      whole_(box, beyond),
      hit_(whole_.column_count()) {}

Erosion::Erosion(const KeyBox& box, const BodyStencil& stencil)
    : window_{stencil.low(), stencil.high()}, beyond_(false), whole_(box), hit_(whole_.column_count()) {
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
  const std::size_t words = from.words();
  for (const std::size_t number : from.stale.numbers()) {
    and_along_z(std::span(from.bits).subspan(number * words, words), low, high, beyond_,
                std::span(to.bits).subspan(number * words, words));
    to.stale.add(number);
  }
}

// Renews the columns of `to` whose window along an axis meets a stale one of `from`, marking what changes.
template <int kAxis>
void Erosion::erode_across(const VoxelColumns& from, VoxelColumns& to) {
  constexpr auto kPlace = static_cast<std::size_t>(kAxis);
  const int size = kAxis == 0 ? from.size_x() : from.size_y();
  const int low = window_.low[kPlace], high = window_.high[kPlace];
  for (const std::size_t number : from.stale.numbers()) {
    const auto [x, y] = from.place(number);
    const int i = kAxis == 0 ? x : y;
    for (int k = std::max(0, i - high); k <= std::min(size - 1, i - low); ++k)
      hit_.add(kAxis == 0 ? from.number(k, y) : from.number(x, k));
  }
  for (const std::size_t number : hit_.numbers()) {
    const auto [x, y] = from.place(number);
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
      to.stale.add(number);
    }
  }
  hit_.clear();
}

// Renews the columns whose stencil meets a stale one.
void Erosion::erode_parts() {
  for (const Part& part : parts_)
    for (const std::size_t number : part.along_z.stale.numbers()) {
      const auto [x, y] = whole_.place(number);
      for (const auto& [dx, dy] : part.columns)
        if (whole_.has_column(x - dx, y - dy)) hit_.add(whole_.number(x - dx, y - dy));
    }
  const auto& [low, high] = window_;
  for (const std::size_t number : hit_.numbers()) {
    // Where the stencil leaves the box nothing is ever set.
    const auto [x, y] = whole_.place(number);
    if (!whole_.has_column(x + low[0], y + low[1]) || !whole_.has_column(x + high[0], y + high[1])) continue;
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
  hit_.clear();
}

void Erosion::erode(const VoxelColumns& columns) {
  if (parts_.empty()) {
    erode_along_z(columns, window_.low[2], window_.high[2], along_[0]);
    erode_across<1>(along_[0], along_[1]);
    erode_across<0>(along_[1], whole_);
  }
  for (Part& part : parts_) erode_along_z(columns, part.low, part.high, part.along_z);
  if (!parts_.empty()) erode_parts();
  for (VoxelColumns& done : along_) done.clear_stale();
  for (Part& part : parts_) part.along_z.clear_stale();
  whole_.clear_stale();
}

}  // namespace frontlux::planner::detail
