#pragma once

#include "goal/goal_query.hpp"

#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// For each target 1 if it is in view from the middle of a voxel, at this yaw or, without one, at any, and no
/// occupied or unknown voxel lies before it.
[[nodiscard]] std::vector<std::uint8_t> seen_targets(const GoalQuery& query, const VoxelKey& from,
                                                     std::optional<double> yaw);

}  // namespace frontlux::planner::detail
