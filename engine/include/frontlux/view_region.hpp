#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>
#include <frontlux/key_box.hpp>

#include <cstdint>
#include <cstdlib>
#include <vector>

namespace frontlux {

/// A field of view at any yaw, in whole voxels: which offsets from the sensor's voxel are in view. It is a
/// table of what `FieldOfView::contains_at_some_yaw` says about (offset * resolution), so the answers are the
/// same, borders included. For each horizontal offset the table holds the greatest height in view. All
/// smaller heights are in view too, upwards and downwards.
///
/// Offsets are in voxels. Thread safety: const members may run at the same time.
class FRONTLUX_EXPORT ViewRegion {
 public:
  static constexpr int kMaxRange = 4096;  ///< [voxels]
  static constexpr int kMargin = 16;  ///< [voxels] beyond the reach; the table has entries for these as well

  /// @param resolution edge length of a voxel [m]
  /// @throws std::invalid_argument naming the value that is out of bounds, also if the range is longer than
  ///                               `kMaxRange` voxels
  ViewRegion(const FieldOfView& view, double resolution);

  /// Greatest height in view at a horizontal offset; -1 if no height is in view.
  [[nodiscard]] int height(int dx, int dy) const {
    if (std::abs(dx) > reach_ || std::abs(dy) > reach_) return -1;
    return heights()[entry(dx, dy)];
  }
  /// Whether a voxel so many voxels away is in the region.
  [[nodiscard]] bool contains(int dx, int dy, int dz) const { return std::abs(dz) <= height(dx, dy); }
  /// Whether one voxel is in the region of another.
  [[nodiscard]] bool contains(const VoxelKey& from, const VoxelKey& to) const {
    return contains(to.x - from.x, to.y - from.y, to.z - from.z);
  }

  /// Along each axis no offset in view is longer.
  [[nodiscard]] int reach() const { return reach_; }
  /// Greatest height of all offsets in view.
  [[nodiscard]] int greatest_height() const { return greatest_height_; }
  /// [voxels^2] Squared length of the longest offset in view.
  [[nodiscard]] double squared_range() const { return voxels_.squared_range; }
  /// Greatest ratio of height to horizontal length of all offsets in view.
  [[nodiscard]] double slope() const { return slope_; }

  /// False only if no voxel of box `to` is in view from a voxel of box `from`.
  [[nodiscard]] bool may_contain_voxel(const KeyBox& from, const KeyBox& to) const {
    return voxels_.may_contain(from, to);
  }
  /// False only if no point of box `to` is in view from a point of box `from`. A box spans the centres of its
  /// voxels.
  [[nodiscard]] bool may_contain_point(const KeyBox& from, const KeyBox& to) const {
    return points_.may_contain(from, to);
  }

  /// The table itself, for loops: `heights()[entry(dx, dy)]` for offsets of at most `reach() + kMargin` along
  /// an axis. Entries are linear in the offset, so that the entry of a difference is the difference of
  /// entries; they may be negative.
  [[nodiscard]] std::int32_t entry(int dx, int dy) const { return dx * (2 * (reach_ + kMargin) + 1) + dy; }
  /// The heights of all columns, to be indexed by `entry`.
  [[nodiscard]] const std::int16_t* heights() const { return heights_.data() + heights_.size() / 2; }

 private:
  // What holds for all offsets in view: bounds on the squared length, on the squared ratio of height to
  // horizontal length, and on the squared horizontal length.
  struct Bounds {
    double squared_range = 0.0, squared_slope = 0.0, squared_width = 0.0;
    [[nodiscard]] bool may_contain(const KeyBox& from, const KeyBox& to) const;
  };

  int reach_;
  int greatest_height_ = 0;
  double slope_ = 0.0;
  Bounds points_, voxels_;
  std::vector<std::int16_t> heights_;
};

}  // namespace frontlux
