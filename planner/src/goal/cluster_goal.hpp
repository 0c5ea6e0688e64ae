#pragma once

#include "goal/goal_query.hpp"

#include <optional>

namespace frontlux::planner::detail {

/// The paper's Sec. VI. Clusters of targets, the best by eq. 1 at their mean first; in each the targets by
/// their distance to that mean; and of the cells that see the first one that any sees, the best by eq. 1 with
/// what is visible in the best window of azimuths that holds it.
[[nodiscard]] std::optional<RenderedCell> find_cluster_goal(const GoalQuery& query);

}  // namespace frontlux::planner::detail
