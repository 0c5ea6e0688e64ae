#include "goal/goal_query.hpp"

#include "casting/visible_segments.hpp"

namespace frontlux::planner::detail {

std::vector<std::uint8_t> GoalQuery::visible_targets(const VoxelKey& from, std::optional<double> yaw) const {
  std::vector<std::size_t> in_view;
  std::vector<KeySegment> segments;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Eigen::Vector3d to_target = offset(from, targets[i]);
    if (yaw ? !view.contains(to_target, *yaw) : !view.contains_at_some_yaw(to_target)) continue;
    in_view.push_back(i);
    segments.push_back({from, targets[i]});
  }
  const std::vector<std::uint8_t> free = visible_segments(caster, segments);
  std::vector<std::uint8_t> visible(targets.size());
  for (std::size_t k = 0; k < in_view.size(); ++k) visible[in_view[k]] = free[k];
  return visible;
}

}  // namespace frontlux::planner::detail
