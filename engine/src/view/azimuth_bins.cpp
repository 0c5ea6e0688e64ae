#include "view/azimuth_bins.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace frontlux::detail {

int azimuth_bin(double azimuth, int count) {
  const double turns = azimuth / (2 * std::numbers::pi);
  const double part = turns - std::floor(turns);  // may round up to 1
  return std::min(static_cast<int>(part * count), count - 1);
}

AzimuthBins::AzimuthBins(const ViewRegion& region, int count) {
  if (count == 0) return;
  const int reach = region.reach();
  middle_ = region.entry(reach, reach);
  bins_.resize(static_cast<std::size_t>(2 * middle_ + 1));
  for (int dx = -reach; dx <= reach; ++dx)
    for (int dy = -reach; dy <= reach; ++dy)
      bins_[static_cast<std::size_t>(middle_ + region.entry(dx, dy))] =
          static_cast<std::uint16_t>(azimuth_bin(std::atan2(dy, dx), count));
}

}  // namespace frontlux::detail
