#pragma once

#include "assignment/bit_columns.hpp"

#include <frontlux/voxel_grid.hpp>

#include <optional>

namespace frontlux::planner::detail {

/// Whether occupied voxels hide a target from a whole box at once.
class Occlusion {
 public:
  /// Hides nothing.
  Occlusion() = default;

  /// @param box  occupied voxels outside do not count; if the box is too large to be worth it, none do
  Occlusion(const VoxelGrid& grid, const KeyBox& box);

  /// True only if no voxel of a box sees the target: between them lies a layer of voxels in which all that
  /// the lines from the box to the target cross is occupied.
  [[nodiscard]] bool hides(const VoxelKey& target, const KeyBox& from) const;

 private:
  [[nodiscard]] bool occupied(const KeyBox& box) const;

  std::optional<BitColumns> walls_;
};

}  // namespace frontlux::planner::detail
