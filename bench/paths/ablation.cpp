#include "paths/ablation.hpp"

#include "random.hpp"
#include "table.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/visible_pairs.hpp>
#include <frontlux/ray_caster.hpp>

#include <cmath>
#include <ctime>
#include <numbers>
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

constexpr int kStarts = 10'000;
constexpr int kTurns = 24;  // directions tried at each step
constexpr std::size_t kViewpoints = 12;
constexpr double kSpacing = 1.2, kClearance = 0.8;  // [m]

class Walk {
 public:
  Walk(const VoxelGrid& grid, const KeyBox& box, std::uint64_t seed) : grid_(grid), box_(box), seed_(seed) {}

  std::optional<std::vector<planner::Pose>> try_once() {
    const Lattice& lattice = grid_.lattice();
    const auto along = [&](std::uint16_t low, std::uint16_t high) {
      return lattice.center(low) + draw() * (lattice.center(high) - lattice.center(low));
    };
    planner::Pose pose;
    pose.position = {along(box_.min.x, box_.max.x), along(box_.min.y, box_.max.y),
                     along(box_.min.z, box_.max.z)};
    if (!is_clear(pose.position)) return std::nullopt;
    pose.yaw = (2.0 * draw() - 1.0) * std::numbers::pi;
    std::vector<planner::Pose> path{pose};
    while (path.size() < kViewpoints)
      if (!step(path)) return std::nullopt;
    path.back().yaw = path[path.size() - 2].yaw;
    return path;
  }

 private:
  double draw() { return uniform(seed_, drawn_++); }

  // Sets the yaw of the last viewpoint to where the next one lies, and adds that.
  bool step(std::vector<planner::Pose>& path) {
    for (int turn = 0; turn < kTurns; ++turn) {
      const double spread = 0.5 + turn * (std::numbers::pi - 0.5) / (kTurns - 1);
      const double yaw = path.back().yaw + (2.0 * draw() - 1.0) * spread;
      const double climb = (2.0 * draw() - 1.0) * 0.2;
      const Eigen::Vector3d ahead(std::cos(climb) * std::cos(yaw), std::cos(climb) * std::sin(yaw),
                                  std::sin(climb));
      if (!is_clear_along(path.back().position, ahead)) continue;
      path.back().yaw = std::remainder(yaw, 2.0 * std::numbers::pi);
      path.push_back({path.back().position + kSpacing * ahead, path.back().yaw});
      return true;
    }
    return false;
  }

  [[nodiscard]] bool is_clear_along(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
    const int parts = static_cast<int>(std::ceil(kSpacing / (grid_.resolution() / 2)));
    for (int i = 1; i <= parts; ++i)
      if (!is_clear(from + kSpacing * i / parts * direction)) return false;
    return true;
  }

  [[nodiscard]] bool is_clear(const Eigen::Vector3d& center) const {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(kClearance / 2);
    const auto min = grid_.lattice().key(Eigen::Vector3f((center - half).cast<float>()));
    const auto max = grid_.lattice().key(Eigen::Vector3f((center + half).cast<float>()));
    const auto is_free = [&](const VoxelKey& key) { return grid_.at(key) == Occupancy::kFree; };
    return min && max && all_of(KeyBox{*min, *max}, is_free);
  }

  const VoxelGrid& grid_;
  KeyBox box_;
  std::uint64_t seed_, drawn_ = 0;
};

// A walk through known free space that keeps its heading where it can: 12 viewpoints, 1.2 m from one to the
// next, and a free cube of 0.8 m about every point of the path. Every yaw is along the path. Nothing if
// 10,000 starts led nowhere.
std::optional<std::vector<planner::Pose>> random_path(const VoxelGrid& grid, std::uint64_t seed) {
  const auto box = grid.known_bounds();
  if (!box) return std::nullopt;
  Walk walk(grid, *box, seed);
  for (int start = 0; start < kStarts; ++start)
    if (auto path = walk.try_once()) return path;
  return std::nullopt;
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
          {"tangent, Ipopt, SUM (paper)", planner::paper_optimizer_options()},
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
  const FrontierSet frontiers(grid, grown(*bounds, 1));
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
  const FrontierSet frontiers(grid, grown(room, 1));
  std::vector<planner::Pose> path(12);
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i].position = {2.4 + 1.2 * static_cast<double>(i), 0.1 * kWidth, 0.1 * kHeight};
  return run_methods(grid, *make_ray_caster(grid), path, frontiers.keys());
}

}  // namespace frontlux::bench
