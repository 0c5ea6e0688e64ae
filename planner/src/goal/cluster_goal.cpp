#include "assignment/corridor_blocks.hpp"
#include "casting/visible_segments.hpp"
#include "goal/goal_query.hpp"
#include "goal/rendered_cell.hpp"

#include <frontlux/view_region.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {
namespace {

struct Cluster {
  std::vector<VoxelKey> targets;  // from the mean outwards
  double quality = 0.0;
};

// Edge of the smallest octree nodes with at least this edge, as a power of two of voxels.
int node_level(double edge, double resolution) {
  int level = 0;
  while (level < 15 && std::ldexp(resolution, level) < edge * (1.0 - 1e-9)) ++level;
  return level;
}

// The best first.
std::vector<Cluster> make_clusters(const GoalQuery& query) {
  const int level = node_level(query.options.cluster_edge, query.lattice.resolution());
  std::map<VoxelKey, std::vector<VoxelKey>> by_node;
  for (const VoxelKey& target : query.targets)
    by_node[make_key(target.x >> level, target.y >> level, target.z >> level)].push_back(target);
  std::vector<Cluster> clusters;
  for (auto& [node, targets] : by_node) {
    const auto count = static_cast<double>(targets.size());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // [m]
    for (const VoxelKey& target : targets) mean += query.lattice.exact_center(target);
    mean /= count;
    std::vector<std::pair<double, VoxelKey>> order;
    for (const VoxelKey& target : targets)
      order.emplace_back((query.lattice.exact_center(target) - mean).norm(), target);
    std::sort(order.begin(), order.end());
    std::transform(order.begin(), order.end(), targets.begin(),
                   [](const auto& entry) { return entry.second; });
    clusters.push_back({std::move(targets), query.quality((mean - query.position).norm(), count)});
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.quality > b.quality; });
  return clusters;
}

// The cells that see a target and are far enough from the robot, sorted.
std::vector<VoxelKey> cells_seeing(const GoalQuery& query, const ViewRegion& region,
                                   const CorridorBlocks& blocks, const VoxelKey& target) {
  std::vector<KeySegment> segments;
  for (const CorridorBlocks::Cube* cube : blocks.cubes_near(target, region))
    cube->for_each_block([&](const BlockCells& block) {
      const BlockCells cells = feasible_cells(block, target, region);
      for (std::uint64_t bits = cells.bits; bits != 0; bits &= bits - 1)
        segments.push_back({cells.key(std::countr_zero(bits)), target});
    });
  const std::vector<std::uint8_t> visible = visible_segments(query.caster, segments);
  std::vector<VoxelKey> cells;
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (visible[i] != 0 && query.far_enough(query.distance(segments[i].from)))
      cells.push_back(segments[i].from);
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace

std::optional<RenderedCell> find_cluster_goal(const GoalQuery& query) {
  if (query.corridor.cells().empty()) return std::nullopt;
  const ViewRegion region(query.view, query.lattice.resolution());
  const CorridorBlocks blocks(query.corridor.cells());
  for (const Cluster& cluster : make_clusters(query))
    for (const VoxelKey& target : cluster.targets) {
      const std::vector<VoxelKey> cells = cells_seeing(query, region, blocks, target);
      if (cells.empty()) continue;
      ViewQualityOptions rendering = query.options.rendering;
      rendering.azimuth_bins = query.bins();
      if (cells.size() <= static_cast<std::size_t>(query.options.refined)) rendering = all_targets(query);
      if (auto best = best_cell(query, render_cells(query, cells, rendering), &target)) return best;
    }
  return std::nullopt;
}

}  // namespace frontlux::planner::detail
