#pragma once

#include <frontlux/field_of_view.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// From which offsets, in voxels, something is in view at some yaw: `FieldOfView::contains_at_some_yaw` as a
/// table. The view is the same on all sides, and what it holds at some distance ends at a height.
class FeasibleRegion {
 public:
  FeasibleRegion(const FieldOfView& view, double resolution);

  /// [voxels] No offset along any axis is longer.
  [[nodiscard]] int reach() const { return reach_; }

  /// Greatest height for this offset along x and y, up or down; negative if there is none.
  [[nodiscard]] int height(int x, int y) const {
    x = x < 0 ? -x : x;
    y = y < 0 ? -y : y;
    if (x > reach_ || y > reach_) return -1;
    return heights_[static_cast<std::size_t>(x) * static_cast<std::size_t>(reach_ + 1) +
                    static_cast<std::size_t>(y)];
  }
  [[nodiscard]] bool contains(int x, int y, int z) const {
    return (x != 0 || y != 0 || z != 0) && (z < 0 ? -z : z) <= height(x, y);
  }

  /// [voxels] Greatest height at any offset.
  [[nodiscard]] int greatest_height() const { return greatest_height_; }
  /// [voxels^2] No offset is longer.
  [[nodiscard]] double squared_range() const { return squared_range_; }
  /// No offset has a greater height over its length along x and y.
  [[nodiscard]] double slope() const { return slope_; }

  /// False only if the region of no voxel of a box holds any of another.
  [[nodiscard]] bool may_meet(const KeyBox& from, const KeyBox& to) const;
  [[nodiscard]] bool may_meet(const VoxelKey& voxel, const KeyBox& box) const {
    return may_meet({voxel, voxel}, box);
  }

  /// All offsets of at most this length [voxels] that it contains, the shortest first.
  [[nodiscard]] std::vector<std::array<int, 3>> offsets(int length) const;

  /// Some offsets from all over it, as many as asked for or a few less.
  [[nodiscard]] std::vector<std::array<int, 3>> spread_offsets(std::size_t count) const;

 private:
  int reach_;
  std::vector<int> heights_;
  double squared_range_ = 0.0;
  double slope_ = 0.0;
  int greatest_height_ = 0;
};

}  // namespace frontlux::planner::detail
