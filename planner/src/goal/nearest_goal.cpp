#include "goal/goal_query.hpp"
#include "goal/rendered_cell.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// Yaw and gain of a cell that sees at least one target.
RenderedCell look_at_nearest(const GoalQuery& query, const VoxelKey& cell, double distance) {
  const std::vector<std::uint8_t> visible = query.visible_targets(cell);
  std::optional<Eigen::Vector3d> nearest;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const Eigen::Vector3d offset = query.offset(cell, query.targets[i]);
    if (visible[i] != 0 && (!nearest || offset.squaredNorm() < nearest->squaredNorm())) nearest = offset;
  }
  RenderedCell goal;
  goal.cell = cell;
  goal.distance = distance;
  goal.yaw = yaw_along(*nearest);
  const std::vector<std::uint8_t> at_yaw = query.visible_targets(cell, goal.yaw);
  goal.hits = static_cast<std::uint32_t>(std::count(at_yaw.begin(), at_yaw.end(), std::uint8_t{1}));
  goal.gain = goal.hits;
  goal.quality = query.quality(distance, goal.gain);
  return goal;
}

}  // namespace

std::optional<RenderedCell> find_nearest_goal(const GoalQuery& query) {
  std::vector<std::pair<double, VoxelKey>> cells;
  for (const VoxelKey& cell : query.corridor.cells()) {
    const double distance = query.corridor.distance(cell).value();
    if (query.far_enough(distance)) cells.emplace_back(distance, cell);
  }
  std::sort(cells.begin(), cells.end());
  std::vector<VoxelKey> batch;
  for (std::size_t begin = 0, count = 64; begin < cells.size(); begin += batch.size(), count *= 2) {
    batch.clear();
    for (std::size_t i = begin; i < std::min(cells.size(), begin + count); ++i)
      batch.push_back(cells[i].second);
    const ViewQualityImage image = render_cells(query, batch, all_targets(query));
    for (std::size_t i = 0; i < batch.size(); ++i)
      if (image.values()[i].hits != 0) return look_at_nearest(query, batch[i], cells[begin + i].first);
  }
  return std::nullopt;
}

}  // namespace frontlux::planner::detail
