#pragma once

#include "view/sector_set.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/view_region.hpp>

#include <cstdint>
#include <vector>

namespace frontlux::detail {

/// The bin of the horizon that holds an azimuth: `count` equal ones, from azimuth 0 upwards.
/// @param azimuth [rad] finite
[[nodiscard]] int azimuth_bin(double azimuth, int count);

/// The azimuth bin of each horizontal offset that a region's table has, by its entry there.
class AzimuthBins {
 public:
  /// @param count  of bins; 0: no table
  AzimuthBins(const ViewRegion& region, int count);

  [[nodiscard]] std::uint16_t operator[](std::int32_t entry) const { return bins_.data()[middle_ + entry]; }

  /// The bins in which a voxel sees points of a box, at any height. @pre there are bins
  [[nodiscard]] SectorSet sectors_of(const VoxelKey& from, const KeyBox& box) const {
    return sectors_of({from, from}, box);
  }
  /// The same for the voxels of a box, all together.
  [[nodiscard]] SectorSet sectors_of(const KeyBox& from, const KeyBox& box) const;

 private:
  [[nodiscard]] int bin_of(int dx, int dy) const;

  int count_;
  int reach_;      // of the table
  int width_ = 0;  // of its rows
  std::ptrdiff_t middle_ = 0;
  std::vector<std::uint16_t> bins_;
};

}  // namespace frontlux::detail
