#pragma once

#include <frontlux/export.hpp>
#include <frontlux/key_box.hpp>
#include <frontlux/planner/travel_corridor.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace frontlux::planner {

/// The voxels around a cell that have to be free for a robot whose body is in the middle of the cell: those
/// that are nearer to the body than its margin. In each column along z they have no gap.
///
/// Of a box they are its collision box, as `TravelOptions` says, and of cells that are nodes the node. A
/// voxel that is as far from the body as the margin, but for a billionth of a voxel, need not be free. Thread
/// safety: reading is safe from any number of threads.
class FRONTLUX_EXPORT BodyStencil {
 public:
  /// Of a column, relative to the cell [voxels], both ends included. It is empty if `low` is above `high`.
  struct Range {
    int low = 0;    ///< the lowest voxel
    int high = -1;  ///< the highest voxel
  };

  /// @param resolution  [m] edge of a voxel
  /// @throws std::invalid_argument naming the extent, if it is not one of a cylinder or a sphere, or if a
  /// round body is wider than 1024 voxels
  BodyStencil(const TravelOptions& options, double resolution);

  /// The corners of the smallest box around, relative to the cell [voxels], both included.
  [[nodiscard]] const std::array<int, 3>& low() const { return low_; }
  [[nodiscard]] const std::array<int, 3>& high() const { return high_; }
  /// Whether it is all of that box.
  [[nodiscard]] bool is_box() const { return columns_.empty(); }
  /// The voxels of a column. @pre `x` and `y` are from `low` to `high`
  [[nodiscard]] Range column(int x, int y) const {
    if (columns_.empty()) return {low_[2], high_[2]};
    return columns_[static_cast<std::size_t>(x - low_[0]) * static_cast<std::size_t>(high_[1] - low_[1] + 1) +
                    static_cast<std::size_t>(y - low_[1])];
  }

  /// How far a body that is not in the middle of a voxel may stick out of the stencil around the voxel, along
  /// each axis [m]. The body fits at a position if all cells are passable that a box of this half width
  /// around the position touches. It is 0 along axes on which the stencil has room for the body anywhere in
  /// the voxel, for robots that drive along z, and for nodes; of round bodies it is up to half a voxel. A ten
  /// thousandth of a voxel does not count, so that a body as wide as its collision box fits in the middle.
  [[nodiscard]] const Eigen::Vector3d& reach() const { return reach_; }

  /// The smallest box around the voxels of a cell, cut off at the end of the key range.
  [[nodiscard]] KeyBox box_around(const VoxelKey& cell) const {
    return {key_at(cell, low_[0], low_[1], low_[2]), key_at(cell, high_[0], high_[1], high_[2])};
  }

  /// Whether a voxel is one of a cell's.
  [[nodiscard]] bool contains(const VoxelKey& cell, const VoxelKey& voxel) const {
    const int x = voxel.x - cell.x, y = voxel.y - cell.y, z = voxel.z - cell.z;
    if (x < low_[0] || x > high_[0] || y < low_[1] || y > high_[1]) return false;
    const Range range = column(x, y);
    return range.low <= z && z <= range.high;
  }

  /// Whether `holds(key)` for every voxel of a cell in the key range; stops at the first for which it does
  /// not.
  template <class Holds>
  [[nodiscard]] bool all_of(const VoxelKey& cell, const Holds& holds) const {
    return frontlux::all_of(box_around(cell),
                            [&](const VoxelKey& key) { return !contains(cell, key) || holds(key); });
  }

  /// Calls `visit(key)` for every voxel of a cell in the key range.
  template <class Visit>
  void for_each(const VoxelKey& cell, const Visit& visit) const {
    static_cast<void>(all_of(cell, [&visit](const VoxelKey& key) { return visit(key), true; }));
  }

 private:
  struct RoundBody;

  void round_off(const RoundBody& body, double resolution);
  static VoxelKey key_at(const VoxelKey& cell, int x, int y, int z) {
    const auto clamped = [](int key) { return std::clamp(key, 0, 0xFFFF); };
    return make_key(clamped(cell.x + x), clamped(cell.y + y), clamped(cell.z + z));
  }

  std::array<int, 3> low_{}, high_{};
  std::vector<Range> columns_;  // by x, then y; none of a box
  Eigen::Vector3d reach_ = Eigen::Vector3d::Zero();
};

}  // namespace frontlux::planner
