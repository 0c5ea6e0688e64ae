#pragma once

#include <frontlux/view_region.hpp>

#include <cstdint>
#include <vector>

namespace frontlux::detail {

/// The bin of the horizon that holds an azimuth: `count` equal ones, from azimuth 0 upwards.
/// @param azimuth [rad] finite
[[nodiscard]] int azimuth_bin(double azimuth, int count);

/// The azimuth bin of each horizontal offset in reach of a region, by its entry in the region's table.
class AzimuthBins {
 public:
  /// @param count  of bins; 0: no table
  AzimuthBins(const ViewRegion& region, int count);

  [[nodiscard]] std::uint16_t operator[](std::int32_t entry) const { return bins_.data()[middle_ + entry]; }

 private:
  std::ptrdiff_t middle_ = 0;
  std::vector<std::uint16_t> bins_;
};

}  // namespace frontlux::detail
