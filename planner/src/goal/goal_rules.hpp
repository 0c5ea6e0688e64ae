#pragma once

#include "goal/goal_query.hpp"

#include <optional>

namespace frontlux::planner::detail {

/// `GoalRule::kClusters`, the paper's Sec. VI. Takes the clusters of targets by eq. 1 at their mean, the best
/// first, and in each cluster the targets by their distance to that mean. The goal is for the first target
/// that any cell sees: of the cells that see it, the best by eq. 1 with what is visible in the best window of
/// azimuths that holds the target.
[[nodiscard]] std::optional<RenderedCell> find_cluster_goal(const GoalQuery& query);

/// `GoalRule::kNearest`. The cell with the shortest path to it from which any target is visible; of equals
/// the one with the smallest key. Its yaw looks at the target nearest to it. Its gain counts the targets that
/// are visible at that yaw.
[[nodiscard]] std::optional<RenderedCell> find_nearest_goal(const GoalQuery& query);

}  // namespace frontlux::planner::detail
