#pragma once

#include "assignment/voxel_columns.hpp"

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
/// A ray between voxels steps along one axis at a time and never back, so all that it crosses is connected
/// to the target by such steps, within one sector of one octant around it. What is connected so through
/// voxels that are not occupied, and no farther above or below than rays of the region come, is found for 64
/// voxels of a column at a time. No cell that sees the target is missed; some that do not see it remain.
class VisibilityFlood {
 public:
  /// Nothing if the region is higher than a word has bits, or the tables would be larger than they are worth.
  /// @param targets  a box around all of them
  /// @pre there are cells
  [[nodiscard]] static std::optional<VisibilityFlood> make(const VoxelGrid& grid,
                                                           std::span<const VoxelKey> corridor,
                                                           const ViewRegion& view, const KeyBox& targets);

  /// Of a row of columns the heights that are connected to the target; one for each thread.
  using Row = std::vector<std::uint64_t>;

  /// Appends the cells from which the target may be in view and rays may arrive.
  void cells(const VoxelKey& target, Row& row, std::vector<VoxelKey>& cells) const;

 private:
  VisibilityFlood(const KeyBox& box, const KeyBox& corridor, const ViewRegion& view);
  void add_walls(const VoxelGrid& grid);
  void cells(const VoxelKey& target, const std::array<int, 3>& side, std::size_t sector, Row& row,
             std::vector<VoxelKey>& cells) const;

  // Parts of a quadrant by azimuth: the narrower, the less is connected that no ray connects.
  static constexpr std::size_t kSectors = 4;

  // Of a column at an offset along x and y: heights at which rays of the region may cross it, and from which
  // the target may be in view.
  struct Limit {
    std::uint64_t crossed = 0, cells = 0;
  };

  VoxelColumns up_, down_;
  KeyBox corridor_;  // around the cells
  int reach_;
  std::array<std::vector<Limit>, kSectors> limits_;  // for x, y
};

}  // namespace frontlux::planner::detail
