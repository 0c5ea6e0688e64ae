#include "goal/cluster_goal.hpp"

#include "assignment/corridor_blocks.hpp"
#include "goal/rendered_goal.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {
namespace {

struct Cluster {
  VoxelKey corner;
  std::vector<VoxelKey> targets;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // [m]
  double quality = 0.0;
};

int node_mask(double edge, double resolution) {
  int log2 = 0;
  while (log2 < 15 && std::ldexp(resolution, log2) < edge * (1.0 - 1e-9)) ++log2;
  return ~((1 << log2) - 1);
}

// The best first; each with its targets from the middle outwards.
std::vector<Cluster> make_clusters(const GoalQuery& query) {
  const int mask = node_mask(query.options.cluster_edge, query.lattice.resolution());
  const auto along = [mask](std::uint16_t k) { return static_cast<std::uint16_t>(k & mask); };
  std::map<VoxelKey, std::vector<VoxelKey>> by_node;
  for (const VoxelKey& target : query.targets)
    by_node[{along(target.x), along(target.y), along(target.z)}].push_back(target);
  std::vector<Cluster> clusters;
  for (auto& [corner, targets] : by_node) {
    Cluster cluster{corner, std::move(targets)};
    for (const VoxelKey& target : cluster.targets) cluster.mean += query.center(target);
    cluster.mean /= static_cast<double>(cluster.targets.size());
    cluster.quality =
        query.quality((cluster.mean - query.position).norm(), static_cast<double>(cluster.targets.size()));
    std::vector<std::pair<double, VoxelKey>> order;
    for (const VoxelKey& target : cluster.targets)
      order.emplace_back((query.center(target) - cluster.mean).norm(), target);
    std::sort(order.begin(), order.end());
    std::transform(order.begin(), order.end(), cluster.targets.begin(),
                   [](const auto& entry) { return entry.second; });
    clusters.push_back(std::move(cluster));
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.quality > b.quality; });
  return clusters;
}

// The cells from which targets are seen, one target at a time.
class Watchers {
 public:
  explicit Watchers(const GoalQuery& query)
      : query_(query), region_(query.view, query.lattice.resolution()), blocks_(query.corridor.cells()) {}

  // Sorted, and far enough from the robot.
  const std::vector<VoxelKey>& of(const VoxelKey& target) {
    list_segments(target);
    visible_.resize(segments_.size());
    query_.caster.visible(std::span<const KeySegment>(segments_), visible_, UnknownPolicy::kBlock);
    cells_.clear();
    for (std::size_t i = 0; i < segments_.size(); ++i)
      if (visible_[i] != 0) cells_.push_back(segments_[i].from);
    std::erase_if(cells_, [this](const VoxelKey& cell) { return !query_.far_enough(query_.distance(cell)); });
    std::sort(cells_.begin(), cells_.end());
    return cells_;
  }

 private:
  void list_segments(const VoxelKey& target) {
    cubes_.clear();
    segments_.clear();
    blocks_.cubes_near(target, region_, cubes_);
    for (const CorridorBlocks::Cube* cube : cubes_)
      for (std::uint64_t filled = cube->filled; filled != 0; filled &= filled - 1) {
        const int block = std::countr_zero(filled);
        const auto at = [&](std::uint16_t base, int shift) {
          return static_cast<std::uint16_t>(base + CorridorBlocks::kBlock * ((block >> shift) & 3));
        };
        const BlockCells cells =
            feasible_cells({{at(cube->corner.x, 4), at(cube->corner.y, 2), at(cube->corner.z, 0)},
                            cube->blocks[static_cast<std::size_t>(block)]},
                           target, region_);
        for (std::uint64_t bits = cells.bits; bits != 0; bits &= bits - 1)
          segments_.push_back({cells.key(std::countr_zero(bits)), target});
      }
  }

  const GoalQuery& query_;
  ViewRegion region_;
  CorridorBlocks blocks_;
  std::vector<const CorridorBlocks::Cube*> cubes_;
  std::vector<KeySegment> segments_;
  std::vector<std::uint8_t> visible_;
  std::vector<VoxelKey> cells_;
};

}  // namespace

std::optional<RenderedCell> find_cluster_goal(const GoalQuery& query) {
  if (query.corridor.cells().empty()) return std::nullopt;
  Watchers watchers(query);
  const auto exactly = static_cast<std::size_t>(query.options.refined);
  for (const Cluster& cluster : make_clusters(query))
    for (const VoxelKey& target : cluster.targets) {
      const std::vector<VoxelKey>& cells = watchers.of(target);
      if (cells.empty()) continue;
      ViewQualityOptions rendering = query.options.rendering;
      rendering.azimuth_bins = query.bins();
      if (cells.size() <= exactly) rendering = all_targets(query);
      const ViewQualityImage image = render_cells(query, cells, rendering);
      if (auto best = best_cell(query, image, &target)) return best;
    }
  return std::nullopt;
}

}  // namespace frontlux::planner::detail
