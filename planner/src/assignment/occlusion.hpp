#pragma once

#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// Tells of whole boxes at once that occupied voxels hide a target from them.
class Occlusion {
 public:
  /// Hides nothing.
  Occlusion() = default;

  /// @param box  blockers outside are not regarded; none at all if the box is too large to be worth it
  Occlusion(const VoxelGrid& grid, const KeyBox& box);

  /// True only if no voxel of a box sees the target: between them lies a layer of voxels in which all that
  /// the lines from the box to the target cross is occupied.
  [[nodiscard]] bool hides(const VoxelKey& target, const KeyBox& from) const;

 private:
  [[nodiscard]] bool occupied(const std::array<int, 3>& low, const std::array<int, 3>& high) const;

  std::array<int, 3> low_{}, size_{};
  std::size_t words_ = 0;            // in a column along z
  std::vector<std::uint64_t> bits_;  // for x, y: a column of z
};

}  // namespace frontlux::planner::detail
