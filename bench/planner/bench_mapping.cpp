// What it costs to take in what two robots see in one step: a lidar's sweep and a depth camera's image into
// the map, its mirror, the ray caster and the frontiers, on one core. OctoMap's own insertPointCloud takes in
// the same scans, step for step, into a tree of its own.

#include "planner/hall.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/ray_caster.hpp>

#include <benchmark/benchmark.h>
#include <octomap/OcTree.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using frontlux::KeyBox;
using frontlux::Lattice;
using frontlux::planner::FrontierSet;
using frontlux::planner::Mapping;
using frontlux::planner::Scan;

constexpr double kResolution = 0.3;  // [m]
constexpr int kSteps = 60;           // of the tour through the hall
constexpr int kWarmUp = 6;           // of which so many are not timed

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct Step {
  Scan lidar, camera;
};

// A ground robot drives along the hall, an aerial robot flies beside it and looks about.
std::vector<Step> make_tour(const frontlux::bench::Hall& hall) {
  std::vector<Step> tour;
  for (int i = 0; i < kSteps; ++i) {
    const float along = static_cast<float>(i) / static_cast<float>(kSteps - 1);
    const float turn = 40.F * along;
    tour.push_back({hall.lidar_scan({4.F + 72.F * along, 8.F + 3.F * std::sin(9.F * along), 0.75F}),
                    hall.camera_scan({4.F + 72.F * along, 26.F + 8.F * std::sin(7.F * along),
                                      2.4F + 2.F * std::sin(turn / 5)},
                                     turn)});
  }
  return tour;
}

// The map of one kind, as far as the tour has come.
class Ours {
 public:
  Ours(const KeyBox& bounds)
      : mapping_({.resolution = kResolution, .bounds = bounds}),
        caster_(frontlux::make_ray_caster(mapping_.grid())),
        frontiers_(mapping_.grid(), bounds) {}

  struct Times {
    double rays = 0, tree = 0, mirror = 0, caster = 0, frontiers = 0;
    [[nodiscard]] double total() const { return rays + tree + mirror + caster + frontiers; }
  };

  Times take_in(const Step& step) {
    Times times;
    std::vector<frontlux::VoxelKey> changed;
    Stopwatch watch;
    double insertion = 0;
    for (const Scan* scan : {&step.lidar, &step.camera}) {
      const auto keys = mapping_.insert(*scan);
      insertion += watch.lap();
      const auto& spent = mapping_.insertion_time();
      times.tree += spent.tree;
      times.mirror += spent.mirror;
      frontiers_.update(mapping_.grid(), keys);
      times.frontiers += watch.lap();
      changed_ += keys.size();
    }
    times.rays = insertion - times.tree - times.mirror;  // checks and end points with them
    watch.lap();
    caster_->update(mapping_.grid());
    times.caster = watch.lap();
    return times;
  }

  [[nodiscard]] const Mapping& mapping() const { return mapping_; }
  [[nodiscard]] std::size_t frontiers() const { return frontiers_.size(); }
  [[nodiscard]] std::size_t changed() const { return changed_; }

 private:
  Mapping mapping_;
  std::unique_ptr<frontlux::RayCaster> caster_;
  FrontierSet frontiers_;
  std::size_t changed_ = 0;
};

// Points as OctoMap takes them: where nothing returned, beyond the range that it is told.
octomap::Pointcloud cloud_of(const Scan& scan) {
  octomap::Pointcloud cloud;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const bool hit = std::isfinite(scan.ranges[i]);
    const Eigen::Vector3f p =
        scan.origin +
        scan.directions[i] * (hit ? scan.ranges[i] + 0.001F : 2.F * static_cast<float>(scan.max_range));
    cloud.push_back(p.x(), p.y(), p.z());
  }
  return cloud;
}

double take_in_by_octomap(octomap::OcTree& tree, const Step& step) {
  double seconds = 0;
  for (const Scan* scan : {&step.lidar, &step.camera}) {
    const auto cloud = cloud_of(*scan);
    const octomap::point3d origin(scan->origin.x(), scan->origin.y(), scan->origin.z());
    Stopwatch watch;
    tree.insertPointCloud(cloud, origin, scan->max_range + 0.0011, false, false);
    seconds += watch.lap();
  }
  return seconds;
}

// Both maps must say the same, but for rays without a return, whose ends the two clouds round differently.
double disagreement(const Mapping& mapping, const octomap::OcTree& tree) {
  const Lattice lattice(kResolution);
  std::size_t known = 0, different = 0;
  for (auto it = tree.begin_leafs(), end = tree.end_leafs(); it != end; ++it) {
    const auto key = it.getKey();
    ++known;
    const auto* node = mapping.tree().search(key, it.getDepth());
    different += node == nullptr || node->getLogOdds() != it->getLogOdds();
  }
  return known == 0 ? 1.0 : static_cast<double>(different) / static_cast<double>(known);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// `laps` tours over the same map: in the first everything is new, in the second nothing is.
void take_in_a_step(benchmark::State& state, int laps) {
  const frontlux::bench::Hall hall;
  const KeyBox bounds = frontlux::planner::voxels_of(Lattice(kResolution), hall.bounds());
  const auto tour = make_tour(hall);
  std::vector<Ours::Times> times;
  std::vector<double> baseline, changed;
  std::unique_ptr<Ours> ours;
  std::unique_ptr<octomap::OcTree> octomap_tree;
  const int end = laps * kSteps, begin = laps == 1 ? kWarmUp : kSteps;
  int at = end;
  double different = 0, frontiers = 0;
  tbb::task_arena one_core(1);
  one_core.execute([&] {
    for (auto _ : state) {
      if (at == end) {
        ours = std::make_unique<Ours>(bounds);
        octomap_tree = std::make_unique<octomap::OcTree>(kResolution);
        for (at = 0; at < begin; ++at) {
          ours->take_in(tour[static_cast<std::size_t>(at % kSteps)]);
          take_in_by_octomap(*octomap_tree, tour[static_cast<std::size_t>(at % kSteps)]);
        }
      }
      const Step& step = tour[static_cast<std::size_t>(at++ % kSteps)];
      const std::size_t changed_before = ours->changed();
      baseline.push_back(take_in_by_octomap(*octomap_tree, step));
      times.push_back(ours->take_in(step));
      changed.push_back(static_cast<double>(ours->changed() - changed_before));
      state.SetIterationTime(times.back().total());
      frontiers = std::max(frontiers, static_cast<double>(ours->frontiers()));
      if (at == end) different = std::max(different, disagreement(ours->mapping(), *octomap_tree));
    }
  });
  if (different > 0.01)
    state.SkipWithError(
        ("OctoMap has another map: " + std::to_string(different) + " of its leaves differ").c_str());
  const auto report = [&](const char* name, auto part) {
    std::vector<double> values;
    for (const auto& t : times) values.push_back(1e3 * part(t));
    state.counters[name] = median(std::move(values));
  };
  report("a_rays_ms", [](const auto& t) { return t.rays; });
  report("b_tree_ms", [](const auto& t) { return t.tree; });
  report("c_mirror_ms", [](const auto& t) { return t.mirror; });
  report("d_frontiers_ms", [](const auto& t) { return t.frontiers; });
  report("e_caster_ms", [](const auto& t) { return t.caster; });
  report("f_total_ms", [](const auto& t) { return t.total(); });
  state.counters["g_total_max_ms"] =
      1e3 * std::max_element(times.begin(), times.end(), [](const auto& a, const auto& b) {
              return a.total() < b.total();
            })->total();
  state.counters["h_octomap_ms"] = 1e3 * median(baseline);
  state.counters["i_changed"] = median(changed);
  state.counters["j_frontiers"] = frontiers;
  state.counters["k_different"] = different;
}

BENCHMARK_CAPTURE(take_in_a_step, new_space, 1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(2 * (kSteps - kWarmUp));
BENCHMARK_CAPTURE(take_in_a_step, known_space, 2)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(2 * kSteps);

}  // namespace

BENCHMARK_MAIN();
