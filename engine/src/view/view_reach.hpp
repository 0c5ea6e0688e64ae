#pragma once

#include "voxel/cell_box.hpp"

#include <frontlux/field_of_view.hpp>
#include <frontlux/ray.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::detail {

/// Which offsets between voxels are in a field of view at some yaw, as a table made by asking
/// `FieldOfView::contains_at_some_yaw` itself about (key difference * resolution): the same answers, borders
/// included, for a look-up. For each horizontal offset it holds the largest height in view; heights up to it
/// are in view too, since both conditions are monotone in the height, in floating point as well.
class ViewReach {
 public:
  static constexpr int kMaxCells = 1024;  ///< longest range in voxels
  static constexpr int kMargin = 16;      ///< voxels beyond the range that the tables still know

  /// @param azimuth_bins  0: none
  /// @throws std::invalid_argument naming the value that is out of bounds
  ViewReach(const FieldOfView& field_of_view, double resolution, int azimuth_bins);

  [[nodiscard]] bool contains(const VoxelKey& from, const VoxelKey& to) const;

  /// False only if no offset between the centres of two voxels of these boxes is in view. Also if the boxes
  /// hold points between the centres.
  [[nodiscard]] bool may_contain(const CellBox& from, const CellBox& to) const;

  /// Largest offset along an axis for which the tables have an entry.
  [[nodiscard]] int table_radius() const { return radius_; }
  /// Entry of a horizontal offset: linear in it, so entries can be computed from differences.
  [[nodiscard]] std::int32_t entry(int dx, int dy) const { return dx * (2 * radius_ + 1) + dy; }
  /// Largest height in view, -1 if none is, at entry(dx, dy); negative entries are valid.
  [[nodiscard]] const std::int16_t* heights() const { return heights_.data() + middle(); }
  /// Azimuth bin at entry(dx, dy).
  [[nodiscard]] const std::uint16_t* bins() const { return bins_.data() + middle(); }

 private:
  [[nodiscard]] std::ptrdiff_t middle() const { return entry(radius_, radius_); }

  int radius_;
  double range_squared_;  // [voxels^2] a little too large, as is the next
  double slope_squared_;
  std::vector<std::int16_t> heights_;
  std::vector<std::uint16_t> bins_;
};

/// Number of the sector of the horizon, of `count` equal ones from azimuth 0 upwards, that holds an azimuth.
/// @param azimuth [rad] finite
[[nodiscard]] int azimuth_bin(double azimuth, int count);

}  // namespace frontlux::detail
