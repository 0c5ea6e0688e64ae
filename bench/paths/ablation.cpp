#include "paths/ablation.hpp"

#include "paths/random_path.hpp"
#include "random.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/ray_caster.hpp>

#include <algorithm>
#include <ctime>
#include <numbers>
#include <span>
#include <stdexcept>

namespace frontlux::bench {
namespace {

constexpr int kRepetitions = 5;  // of which the median counts

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Work>
double median_seconds(Work&& work) {
  std::vector<double> seconds;
  for (int i = 0; i < kRepetitions; ++i) {
    const double start = processor_seconds();
    work();
    seconds.push_back(processor_seconds() - start);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[kRepetitions / 2];
}

void run_methods(std::span<const planner::Pose> path, std::span<const Eigen::Vector3d> frontiers,
                 const planner::VisiblePairs& pairs, PathTrial& trial) {
  trial.pairs = pairs.size();
  for (const YawMethod& method : yaw_methods()) {
    YawTrial result;
    result.seconds = median_seconds([&] {
      if (!method.options) {
        const planner::InformationGain gain(path, frontiers, pairs, camera_view());
        result.distinct = gain.distinct(planner::tangent_yaws(path));
        return;
      }
      const auto optimized = planner::optimize_path(path, frontiers, pairs, camera_view(), *method.options);
      result.distinct = optimized.result.distinct;
      result.evaluations = optimized.evaluations;
    });
    trial.by_method.push_back(result);
  }
}

// By one voxel, for the frontiers around what is known.
KeyBox grown(KeyBox box) {
  const auto down = [](std::uint16_t k) { return static_cast<std::uint16_t>(k - (k > 0)); };
  const auto up = [](std::uint16_t k) { return static_cast<std::uint16_t>(k + (k < 0xFFFF)); };
  box.min = {down(box.min.x), down(box.min.y), down(box.min.z)};
  box.max = {up(box.max.x), up(box.max.y), up(box.max.z)};
  return box;
}

}  // namespace

FieldOfView camera_view() {
  return {FieldOfView::Shape::kPyramid, std::numbers::pi / 2, 0.4 * std::numbers::pi, 10.0};
}

MapTrial run_ablation(const std::string& name, const VoxelGrid& grid, int seeds) {
  MapTrial map{name, 0, {}};
  const auto bounds = grid.known_bounds();
  if (!bounds) throw std::runtime_error(name + ": nothing in this map is known");
  const planner::FrontierSet set(grid, grown(*bounds));
  const std::span<const VoxelKey> frontiers = set.keys();
  const auto targets = planner::centers(grid.lattice(), frontiers);
  const auto caster = make_ray_caster(grid);
  map.frontiers = frontiers.size();
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto path = random_path(grid, static_cast<std::uint64_t>(seed));
    if (!path) throw std::runtime_error(name + ": no path of 12 viewpoints fits into its free space");
    PathTrial trial;
    planner::VisiblePairs pairs;
    trial.visibility_seconds = median_seconds(
        [&] { pairs = planner::visible_pairs(*caster, grid, *path, frontiers, camera_view()); });
    run_methods(*path, targets, pairs, trial);
    map.paths.push_back(std::move(trial));
  }
  return map;
}

PathTrial run_large_path() {
  constexpr int kLength = 90, kWidth = 28, kHeight = 20;  // [voxels]
  const auto key = [](int x, int y, int z) {
    const auto along = [](int k) { return static_cast<std::uint16_t>(Lattice::kOrigin + k); };
    return VoxelKey{along(x), along(y), along(z)};
  };
  VoxelGrid grid(0.2);
  for (int x = 0; x < kLength; ++x)
    for (int y = 0; y < kWidth; ++y)
      for (int z = 0; z < kHeight; ++z) grid.set(key(x, y, z), Occupancy::kFree);
  const planner::FrontierSet set(grid, {key(-1, -1, -1), key(kLength, kWidth, kHeight)});
  const auto caster = make_ray_caster(grid);
  std::vector<planner::Pose> path(12);
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i].position = {2.4 + 1.2 * static_cast<double>(i), 0.1 * kWidth, 0.1 * kHeight};
  PathTrial trial;
  planner::VisiblePairs pairs;
  trial.visibility_seconds =
      median_seconds([&] { pairs = planner::visible_pairs(*caster, grid, path, set.keys(), camera_view()); });
  run_methods(path, planner::centers(grid.lattice(), set.keys()), pairs, trial);
  return trial;
}

}  // namespace frontlux::bench
