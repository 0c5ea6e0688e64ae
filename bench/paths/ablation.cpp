#include "paths/ablation.hpp"

#include "paths/random_path.hpp"
#include "table.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/visible_pairs.hpp>
#include <frontlux/ray_caster.hpp>

#include <ctime>
#include <span>
#include <stdexcept>

namespace frontlux::bench {
namespace {

constexpr int kRepetitions = 5;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Work>
double median_seconds(Work&& work) {
  std::vector<double> seconds;
  for (int i = 0; i < kRepetitions; ++i) {
    const double start = processor_seconds();
    work();
    seconds.push_back(processor_seconds() - start);
  }
  return median(std::move(seconds));
}

PathTrial run_methods(const VoxelGrid& grid, const RayCaster& caster, std::span<const planner::Pose> path,
                      std::span<const VoxelKey> keys) {
  const FieldOfView view = planner::uav().view;
  const auto frontiers = planner::centers(grid.lattice(), keys);
  PathTrial trial;
  planner::VisiblePairs pairs;
  trial.visibility_seconds =
      median_seconds([&] { pairs = planner::visible_pairs(caster, grid, path, keys, view); });
  trial.pairs = pairs.size();
  for (const YawMethod& method : yaw_methods()) {
    YawTrial result;
    result.seconds = median_seconds([&] {
      if (!method.options) {
        const planner::InformationGain gain(path, frontiers, pairs, view);
        result.distinct = gain.distinct(planner::tangent_yaws(path));
        return;
      }
      const auto optimized = planner::optimize_path(path, frontiers, pairs, view, *method.options);
      result.distinct = optimized.result.distinct;
      result.evaluations = optimized.evaluations;
    });
    trial.by_method.push_back(result);
  }
  return trial;
}

}  // namespace

std::vector<YawMethod> yaw_methods() {
  using planner::GainMode, planner::PathOptimizerOptions, planner::YawStart;
  const auto with = [](YawStart start, bool ascend, GainMode mode) {
    PathOptimizerOptions options;
    options.start = start;
    options.ascend = ascend;
    options.gain.mode = mode;
    if (start != YawStart::kGreedy) options.max_evaluations = 60;
    return options;
  };
  auto fine = with(YawStart::kGreedy, false, GainMode::kOr);
  fine.yaw_bins = 60;
  return {{"tangent", std::nullopt},
          {"tangent, Ipopt, SUM (paper)", planner::paper_path_options()},
          {"tangent, Ipopt, OR", with(YawStart::kTangent, true, GainMode::kOr)},
          {"best of 24 bins", with(YawStart::kBestBins, false, GainMode::kSum)},
          {"best of 24 bins, Ipopt, SUM", with(YawStart::kBestBins, true, GainMode::kSum)},
          {"best of 24 bins, Ipopt, OR", with(YawStart::kBestBins, true, GainMode::kOr)},
          {"greedy among 24 bins", with(YawStart::kGreedy, false, GainMode::kOr)},
          {"greedy among 60 bins", fine},
          {"greedy among 24 bins, Ipopt, SUM", with(YawStart::kGreedy, true, GainMode::kSum)},
          {"greedy among 24 bins, Ipopt, OR (default)", with(YawStart::kGreedy, true, GainMode::kOr)}};
}

MapTrial run_ablation(const std::string& name, const VoxelGrid& grid, int seeds) {
  MapTrial map{name, 0, {}};
  const auto bounds = grid.known_bounds();
  if (!bounds) throw std::runtime_error(name + ": all voxels of this map are unknown");
  const planner::FrontierSet frontiers(grid, grown(*bounds, 1));
  const auto caster = make_ray_caster(grid);
  map.frontiers = frontiers.keys().size();
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto path = random_path(grid, static_cast<std::uint64_t>(seed));
    if (!path) throw std::runtime_error(name + ": no path of 12 viewpoints fits into its free space");
    map.paths.push_back(run_methods(grid, *caster, *path, frontiers.keys()));
  }
  return map;
}

PathTrial run_large_path() {
  constexpr int kOrigin = Lattice::kOrigin, kLength = 90, kWidth = 28, kHeight = 20;  // [voxels]
  const KeyBox room{make_key(kOrigin, kOrigin, kOrigin),
                    make_key(kOrigin + kLength - 1, kOrigin + kWidth - 1, kOrigin + kHeight - 1)};
  VoxelGrid grid(0.2);
  for_each_key(room, [&](const VoxelKey& key) { grid.set(key, Occupancy::kFree); });
  const planner::FrontierSet frontiers(grid, grown(room, 1));
  std::vector<planner::Pose> path(12);
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i].position = {2.4 + 1.2 * static_cast<double>(i), 0.1 * kWidth, 0.1 * kHeight};
  return run_methods(grid, *make_ray_caster(grid), path, frontiers.keys());
}

}  // namespace frontlux::bench
