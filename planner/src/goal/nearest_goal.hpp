#pragma once

#include "goal/goal_query.hpp"

#include <optional>

namespace frontlux::planner::detail {

/// The nearest cell, by the way to it, of equals the one with the smallest key, from which any target is
/// visible; its yaw looks at the target nearest to it. Its gain counts the targets that are visible at that
/// yaw.
[[nodiscard]] std::optional<RenderedCell> find_nearest_goal(const GoalQuery& query);

}  // namespace frontlux::planner::detail
