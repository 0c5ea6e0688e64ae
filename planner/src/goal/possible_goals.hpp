#pragma once

#include "goal/goal_query.hpp"

#include <frontlux/ray.hpp>

#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// What is left of some cells in search of a goal.
struct PossibleGoals {
  /// In the order given. Left out are those that are not far enough, that have no target in their reach, or
  /// that would be worse than `counted` even if they saw all targets that one yaw may show them.
  std::vector<VoxelKey> cells;
  std::optional<RenderedCell> counted;  ///< best of a few, counted with all targets; none if they see none
};

[[nodiscard]] PossibleGoals possible_goals(const GoalQuery& query, std::span<const VoxelKey> cells);

}  // namespace frontlux::planner::detail
