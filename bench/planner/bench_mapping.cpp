// The time to insert the scans of two robots in one step, a lidar scan and a depth image, into the map, its
// mirror, the ray caster and the frontiers, on one core. OctoMap's own insertPointCloud inserts the same
// scans, step by step, into another octree.

#include "random.hpp"
#include "table.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/sim/sensor.hpp>
#include <frontlux/sim/surface.hpp>
#include <frontlux/sim/world.hpp>
#include <frontlux/stopwatch.hpp>

#include <benchmark/benchmark.h>
#include <octomap/OcTree.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace {

using frontlux::KeyBox, frontlux::Lattice, frontlux::FrontierSet, frontlux::planner::Mapping,
    frontlux::planner::Pose, frontlux::planner::Scan;

constexpr double kResolution = 0.3;  // [m]
constexpr int kSteps = 60;           // of the tour through the hall
constexpr int kWarmUp = 6;           // of which so many are not timed

struct Step {
  Scan lidar, camera;
};

void add_box(frontlux::sim::TriangleMesh& mesh, float x, float y, float z, float dx, float dy, float dz) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(x + dx * static_cast<float>(i & 1), y + dy * static_cast<float>(i >> 1 & 1),
                               z + dz * static_cast<float>(i >> 2));
  // Each face by its corners, in order around it.
  for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{0, 2, 6, 4},
                                   {1, 3, 7, 5},
                                   {0, 1, 5, 4},
                                   {2, 3, 7, 6},
                                   {0, 1, 3, 2},
                                   {4, 5, 7, 6}}) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  }
}

const Eigen::AlignedBox3d kHallBounds(Eigen::Vector3d(-0.3, -0.3, -0.3), Eigen::Vector3d(80.1, 40.2, 12.3));

// A closed hall of 80 x 40 x 12 m with columns and crates.
frontlux::sim::Surface make_hall() {
  constexpr float kLength = 80.F, kWidth = 40.F, kHeight = 12.F, kFloor = -0.05F;  // [m]
  frontlux::sim::TriangleMesh mesh;
  add_box(mesh, 0, 0, kFloor, kLength, kWidth, kHeight - kFloor);
  for (float x = 5.F; x < kLength; x += 6.F)
    for (const float y : {3.F, 15.F, 37.F}) add_box(mesh, x, y, kFloor, 0.6F, 0.6F, kHeight);
  for (std::uint64_t i = 0; i < 60; ++i) {  // crates on both sides of the ground robot's path
    const auto draw = [&](std::uint64_t stream, float low, float high) {
      return low + (high - low) * static_cast<float>(frontlux::bench::uniform(stream, i));
    };
    const float y = i % 2 == 0 ? draw(1, 0.3F, 2.5F) : draw(1, 13.F, 16.F);
    add_box(mesh, draw(2, 0.F, kLength - 3.F), y, kFloor, draw(3, 0.5F, 2.5F), draw(4, 0.5F, 1.5F),
            draw(5, 0.4F, 3.F));
  }
  return frontlux::sim::Surface(mesh);
}

// A ground robot drives along the hall, an aerial robot flies beside it and turns.
std::vector<Step> make_tour() {
  const auto hall = make_hall();
  const frontlux::sim::Sensor lidar = frontlux::sim::sensor_of(frontlux::planner::ugv_description()),
                              depth_camera = frontlux::sim::sensor_of(frontlux::planner::uav_description());
  std::vector<Step> tour;
  for (int i = 0; i < kSteps; ++i) {
    const double along = static_cast<double>(i) / (kSteps - 1), turn = 40 * along;
    const Pose ground{{4 + 72 * along, 8 + 3 * std::sin(9 * along), 0.75}, 0.0};
    const Pose air{{4 + 72 * along, 26 + 8 * std::sin(7 * along), 2.4 + 2 * std::sin(turn / 5)}, turn};
    tour.push_back({sense(hall, lidar, ground, 0), sense(hall, depth_camera, air, 0)});
  }
  return tour;
}

// The map, its mirror, the caster and the frontiers.
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

  Times insert(const Step& step) {
    Times times;
    std::vector<frontlux::VoxelKey> changed;
    frontlux::Stopwatch watch;
    double insertion = 0;
    for (const Scan* scan : {&step.lidar, &step.camera}) {
      const frontlux::MapChange change = mapping_.insert(*scan);
      insertion += watch.lap();
      const auto& spent = mapping_.insertion_time();
      times.tree += spent.tree;
      times.mirror += spent.mirror;
      frontiers_.update(change);
      times.frontiers += watch.lap();
      changed_ += change.keys.size();
    }
    times.rays = insertion - times.tree - times.mirror;  // with checks and end points
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

// Points for OctoMap; those of rays without a return lie beyond the range.
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

// OctoMap's tree with its virtual functions as compiled here, with this project's flags, instead of those in
// its library.
struct OwnOcTree final : octomap::OcTree {
  using OcTree::OcTree;
};

double insert_by_octomap(OwnOcTree& tree, const Step& step) {
  double seconds = 0;
  for (const Scan* scan : {&step.lidar, &step.camera}) {
    const auto cloud = cloud_of(*scan);
    const octomap::point3d origin(scan->origin.x(), scan->origin.y(), scan->origin.z());
    const frontlux::Stopwatch watch;
    tree.insertPointCloud(cloud, origin, scan->max_range + 0.0011, false, false);
    seconds += watch.seconds();
  }
  return seconds;
}

// Fraction of the leaves of one tree that the other one does not have so.
double disagreement(const octomap::OcTree& a, const octomap::OcTree& b) {
  std::size_t known = 0, different = 0;
  for (auto it = a.begin_leafs(), end = a.end_leafs(); it != end; ++it) {
    ++known;
    const auto* node = b.search(it.getKey(), it.getDepth());
    different += node == nullptr || node->getLogOdds() != it->getLogOdds();
  }
  return known == 0 ? 1.0 : static_cast<double>(different) / static_cast<double>(known);
}

// `laps` tours over the same map: the first in new space, the second in known space.
void insert_a_step(benchmark::State& state, int laps) {
  const KeyBox bounds = frontlux::planner::voxels_of(Lattice(kResolution), kHallBounds);
  const auto tour = make_tour();
  std::vector<Ours::Times> times;
  std::vector<double> baseline, changed;
  std::unique_ptr<Ours> ours;
  std::unique_ptr<OwnOcTree> octomap_tree;
  const int end = laps * kSteps, begin = laps == 1 ? kWarmUp : kSteps;
  int at = end;
  double different = 0, frontiers = 0;
  tbb::task_arena one_core(1);
  one_core.execute([&] {
    for (auto _ : state) {
      if (at == end) {
        ours = std::make_unique<Ours>(bounds);
        octomap_tree = std::make_unique<OwnOcTree>(kResolution);
        for (at = 0; at < begin; ++at) {
          ours->insert(tour[static_cast<std::size_t>(at % kSteps)]);
          insert_by_octomap(*octomap_tree, tour[static_cast<std::size_t>(at % kSteps)]);
        }
      }
      const Step& step = tour[static_cast<std::size_t>(at++ % kSteps)];
      const std::size_t changed_before = ours->changed();
      baseline.push_back(insert_by_octomap(*octomap_tree, step));
      times.push_back(ours->insert(step));
      changed.push_back(static_cast<double>(ours->changed() - changed_before));
      state.SetIterationTime(times.back().total());
      frontiers = std::max(frontiers, static_cast<double>(ours->frontiers()));
      if (at == end)
        different = std::max({different, disagreement(ours->mapping().tree(), *octomap_tree),
                              disagreement(*octomap_tree, ours->mapping().tree())});
    }
  });
  // Only rays without a return may differ: the two clouds round their ends.
  if (different > 0.01)
    state.SkipWithError(
        ("the map differs from OctoMap's: fraction of different leaves " + std::to_string(different))
            .c_str());
  const auto report = [&](const char* name, auto part) {
    std::vector<double> values;
    for (const auto& t : times) values.push_back(1e3 * part(t));
    state.counters[name] = frontlux::bench::median(std::move(values));
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
  state.counters["h_octomap_ms"] = 1e3 * frontlux::bench::median(baseline);
  state.counters["i_changed"] = frontlux::bench::median(changed);
  state.counters["j_frontiers"] = frontiers;
  state.counters["k_different"] = different;
}

BENCHMARK_CAPTURE(insert_a_step, new_space, 1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(2 * (kSteps - kWarmUp));
BENCHMARK_CAPTURE(insert_a_step, known_space, 2)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(2 * kSteps);

}  // namespace

BENCHMARK_MAIN();
