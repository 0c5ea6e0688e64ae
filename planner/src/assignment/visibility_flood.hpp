#pragma once

#include "assignment/bit_columns.hpp"

#include <frontlux/view_region.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Finds the cells of a corridor from which a ray to a target may arrive at all.
///
/// A ray between voxels steps along one axis at a time and never back. So such steps connect all that it
/// crosses to the target, within one sector of one octant around the target. The flood finds what is
/// connected so through voxels that are not occupied, no farther above or below than rays of the region come,
/// for 64 voxels of a column at a time. It misses no cell that sees the target; some that do not remain.
class VisibilityFlood {
 public:
  /// Nothing if the region is higher than a word has bits, or if the tables would be too large to be worth
  /// it.
  /// @param targets  a box around all of them
  /// @pre there are cells
  [[nodiscard]] static std::optional<VisibilityFlood> make(const VoxelGrid& grid,
                                                           std::span<const VoxelKey> corridor,
                                                           const ViewRegion& region, const KeyBox& targets);

  /// Of a row of columns the heights that are connected to the target; one for each thread.
  using Row = std::vector<std::uint64_t>;

  /// Appends the cells from which the target may be in view and rays may arrive.
  void cells(const VoxelKey& target, Row& row, std::vector<VoxelKey>& cells) const;

 private:
  VisibilityFlood(const KeyBox& box, const KeyBox& corridor, const ViewRegion& region);
  void cells(const VoxelKey& target, const std::array<int, 3>& side, std::size_t sector, Row& row,
             std::vector<VoxelKey>& cells) const;

  // Parts of a quadrant by azimuth. The narrower they are, the less is connected that no ray connects.
  static constexpr std::size_t kSectors = 4;

  // Of a column at an offset along x and y: heights at which rays may cross it, and that may see the target.
  struct Limit {
    std::uint64_t crossed = 0, cells = 0;
  };

  // The same voxels twice: as columns upwards and downwards.
  struct Columns {
    BitColumns walls, cells;
  };
  Columns up_, down_;
  KeyBox corridor_;  // around the cells
  int reach_;
  std::array<std::vector<Limit>, kSectors> limits_;  // for x, y
};

}  // namespace frontlux::planner::detail
