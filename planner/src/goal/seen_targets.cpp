#include "goal/seen_targets.hpp"

namespace frontlux::planner::detail {

std::vector<std::uint8_t> seen_targets(const GoalQuery& query, const VoxelKey& from,
                                       std::optional<double> yaw) {
  std::vector<std::size_t> in_view;
  std::vector<KeySegment> segments;
  for (std::size_t i = 0; i < query.targets.size(); ++i) {
    const Eigen::Vector3d offset = query.offset(from, query.targets[i]);
    if (yaw ? !query.view.contains(offset, *yaw) : !query.view.contains_at_some_yaw(offset)) continue;
    in_view.push_back(i);
    segments.push_back({from, query.targets[i]});
  }
  std::vector<std::uint8_t> visible(segments.size()), seen(query.targets.size());
  query.caster.visible(std::span<const KeySegment>(segments), visible, UnknownPolicy::kBlock);
  for (std::size_t k = 0; k < in_view.size(); ++k) seen[in_view[k]] = visible[k];
  return seen;
}

}  // namespace frontlux::planner::detail
