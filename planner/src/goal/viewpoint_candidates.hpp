#pragma once

#include "goal/goal_query.hpp"

#include <frontlux/ray.hpp>

#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Some cells that stand for all: the smallest in each cube of `stride` voxels a side, so that narrow places
/// keep a cell, and every one within `surroundings` voxels of the robot along each axis. Sorted.
/// @param cells  sorted, each once
[[nodiscard]] std::vector<VoxelKey> spaced_cells(std::span<const VoxelKey> cells, int stride,
                                                 const VoxelKey& robot, int surroundings);

/// The cells that may be the goal.
struct PossibleGoals {
  /// In the order given. Left out are cells that are not far enough, that have no target in their reach, or
  /// that would be worse than `counted` even if they saw all targets that one yaw may show them.
  std::vector<VoxelKey> cells;
  std::optional<RenderedCell> counted;  ///< best of a few, counted with all targets; none if they see none
};

[[nodiscard]] PossibleGoals possible_goals(const GoalQuery& query, std::span<const VoxelKey> cells);

}  // namespace frontlux::planner::detail
