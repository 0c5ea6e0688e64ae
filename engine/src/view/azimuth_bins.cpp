#include "view/azimuth_bins.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace frontlux::detail {

int azimuth_bin(double azimuth, int count) {
  const double turns = azimuth / (2 * std::numbers::pi);
  const double part = turns - std::floor(turns);  // may round up to 1
  return std::min(static_cast<int>(part * count), count - 1);
}

AzimuthBins::AzimuthBins(const ViewRegion& region, int count)
    : count_(count), reach_(region.reach() + ViewRegion::kMargin) {
  if (count == 0) return;
  width_ = region.entry(1, 0);
  middle_ = region.entry(reach_, reach_);
  bins_.resize(static_cast<std::size_t>(2 * middle_ + 1));
  for (int dx = -reach_; dx <= reach_; ++dx)
    for (int dy = -reach_; dy <= reach_; ++dy)
      bins_[static_cast<std::size_t>(middle_ + region.entry(dx, dy))] =
          static_cast<std::uint16_t>(azimuth_bin(std::atan2(dy, dx), count));
}

int AzimuthBins::bin_of(int dx, int dy) const {
  if (std::max(std::abs(dx), std::abs(dy)) > reach_) return azimuth_bin(std::atan2(dy, dx), count_);
  return (*this)[dx * width_ + dy];
}

SectorSet AzimuthBins::sectors_of(const KeyBox& from, const KeyBox& box) const {
  const int left = box.min.x - from.max.x, right = box.max.x - from.min.x;
  const int near = box.min.y - from.max.y, far = box.max.y - from.min.y;
  // The corner that comes first on a turn to the left, and the one that comes last.
  const auto between = [&](int x, int y, int last_x, int last_y) {
    return SectorSet::between(bin_of(x, y), bin_of(last_x, last_y), count_);
  };
  if (left > 0) return between(near > 0 ? right : left, near, far > 0 ? left : right, far);
  if (right < 0) return between(far > 0 ? right : left, far, near < 0 ? right : left, near);
  if (near > 0) return between(right, near, left, near);
  if (far < 0) return between(left, far, right, far);
  return SectorSet::all();
}

}  // namespace frontlux::detail
