#include "goal/goal_query.hpp"
#include "goal/rendered_cell.hpp"

#include <frontlux/key_box.hpp>

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// Of each cluster of targets that touch each other, the target nearest to their mean; of equals that with the
// smallest key. Sorted.
std::vector<VoxelKey> middles_of_clusters(const GoalQuery& query) {
  std::set<VoxelKey> left(query.targets.begin(), query.targets.end());
  std::vector<VoxelKey> middles, cluster;
  while (!left.empty()) {
    cluster.assign(1, *left.begin());
    left.erase(left.begin());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // in whole numbers, so that equals are equal
    const auto place = [&](const VoxelKey& key) { return Eigen::Vector3d(key.x, key.y, key.z); };
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      const VoxelKey key = cluster[i];
      sum += place(key);
      for_each_key(grown({key, key}, 1), [&](const VoxelKey& neighbor) {
        if (left.erase(neighbor) > 0) cluster.push_back(neighbor);
      });
    }
    const auto count = static_cast<double>(cluster.size());
    middles.push_back(std::ranges::min(cluster, {}, [&](const VoxelKey& key) {
      return std::pair((count * place(key) - sum).squaredNorm(), key);
    }));
  }
  std::sort(middles.begin(), middles.end());
  return middles;
}

// Yaw and gain of a cell that sees at least one of some targets.
RenderedCell look_at_nearest(const GoalQuery& query, const GoalQuery& of_some, const VoxelKey& cell,
                             double distance) {
  const std::vector<std::uint8_t> visible = of_some.visible_targets(cell);
  std::optional<Eigen::Vector3d> nearest;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const Eigen::Vector3d offset = query.offset(cell, of_some.targets[i]);
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

// The cell with the shortest path to it from which one of some targets is visible.
std::optional<RenderedCell> find_nearest_cell(const GoalQuery& query, std::span<const VoxelKey> targets,
                                              std::span<const std::pair<double, VoxelKey>> cells) {
  GoalQuery of_some = query;
  of_some.targets = targets;
  std::vector<VoxelKey> batch;
  for (std::size_t begin = 0, count = 64; begin < cells.size(); begin += batch.size(), count *= 2) {
    batch.clear();
    for (std::size_t i = begin; i < std::min(cells.size(), begin + count); ++i)
      batch.push_back(cells[i].second);
    const ViewQualityImage image = render_cells(of_some, batch, all_targets(of_some));
    for (std::size_t i = 0; i < batch.size(); ++i)
      if (image.values()[i].hits != 0)
        return look_at_nearest(query, of_some, batch[i], cells[begin + i].first);
  }
  return std::nullopt;
}

}  // namespace

std::optional<RenderedCell> find_nearest_goal(const GoalQuery& query) {
  std::vector<std::pair<double, VoxelKey>> cells;
  for (const VoxelKey& cell : query.corridor.cells()) {
    const double distance = query.corridor.distance(cell).value();
    if (query.far_enough(distance)) cells.emplace_back(distance, cell);
  }
  std::sort(cells.begin(), cells.end());
  if (auto goal = find_nearest_cell(query, middles_of_clusters(query), cells)) return goal;
  return find_nearest_cell(query, query.targets, cells);
}

}  // namespace frontlux::planner::detail
