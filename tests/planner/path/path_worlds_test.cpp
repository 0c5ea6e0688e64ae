#include "support/random.hpp"

#include <frontlux/planner/path_planner.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground_truth.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace frontlux::planner {
namespace {

constexpr double kResolution = 0.3;

// A world whose every observable voxel is known.
struct KnownWorld {
  sim::World world;
  sim::GroundTruth truth;
  VoxelGrid grid{kResolution};

  explicit KnownWorld(const std::string& name)
      : world(sim::make_world(name, 1)),
        truth(world, kResolution, *world.start + Eigen::Vector3d(0, 0, 0.8)) {
    truth.for_each_observable([this](const VoxelKey& key, sim::Truth state) {
      grid.set(key, state == sim::Truth::kFree ? Occupancy::kFree : Occupancy::kOccupied);
    });
  }
};

struct Box {
  int half, below, above;  // [voxels] around the one that holds the robot
};

VoxelKey voxel_at(const Lattice& lattice, const Eigen::Vector3d& at) {
  return {*lattice.key(at.x()), *lattice.key(at.y()), *lattice.key(at.z())};
}

bool box_is_free(const VoxelGrid& grid, const VoxelKey& at, const Box& box) {
  for (int x = at.x - box.half; x <= at.x + box.half; ++x)
    for (int y = at.y - box.half; y <= at.y + box.half; ++y)
      for (int z = at.z - box.below; z <= at.z + box.above; ++z)
        if (grid.at({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                     static_cast<std::uint16_t>(z)}) != Occupancy::kFree)
          return false;
  return true;
}

// At a tenth of a voxel, without the corridor.
void expect_free(const VoxelGrid& grid, const PathPlan& plan, const Box& box) {
  VoxelKey last{};
  for (std::size_t i = 1; i < plan.viewpoints.size(); ++i) {
    const Eigen::Vector3d from = plan.viewpoints[i - 1].position, to = plan.viewpoints[i].position;
    const int steps = 1 + static_cast<int>((to - from).norm() / (kResolution / 10));
    for (int k = 0; k <= steps; ++k) {
      const Eigen::Vector3d at = from + (to - from) * (static_cast<double>(k) / steps);
      const VoxelKey key = voxel_at(grid.lattice(), at);
      if (key == last) continue;
      last = key;
      ASSERT_TRUE(box_is_free(grid, key, box)) << "at " << at.transpose();
    }
  }
}

Pose random_pose(test::Random& random, const Lattice& lattice, const TravelCorridor& corridor,
                 double height) {
  const VoxelKey cell =
      corridor.cells()[static_cast<std::size_t>(random.below(static_cast<int>(corridor.cells().size())))];
  const auto along = [&](std::uint16_t key) {
    return lattice.center(key) + random.uniform(-0.499, 0.499) * kResolution;
  };
  const double x = along(cell.x), y = along(cell.y), z = along(cell.z);
  return {{x, y, height > 0.0 ? height : z}, random.uniform(-3.0, 3.0)};
}

double at_part(std::vector<double> numbers, double part) {
  std::sort(numbers.begin(), numbers.end());
  return numbers[static_cast<std::size_t>(part * static_cast<double>(numbers.size() - 1))];
}

void check_pairs(const std::string& name, const KnownWorld& known, const TravelOptions& travel, double height,
                 const Box& box, const PathOptions& options, int pairs) {
  const Lattice& lattice = known.grid.lattice();
  TravelCorridor corridor(travel, lattice, known.truth.bounds());
  Eigen::Vector3d robot = *known.world.start;
  robot.z() = height > 0.0 ? height : 1.35;
  corridor.update({known.grid}, voxel_at(lattice, robot));
  ASSERT_EQ(corridor.state(), CorridorState::kReady) << describe(corridor.state());

  test::Random random(5);
  std::vector<double> times, ratios;
  int fell_back = 0;
  for (int i = 0; i < pairs; ++i) {
    // It may start where its body does not quite fit, as when the map has changed, but cannot be told to go
    // there.
    const Pose start = random_pose(random, lattice, corridor, height);
    Pose goal = random_pose(random, lattice, corridor, height);
    while (!way_is_free(corridor, lattice, goal.position, goal.position))
      goal = random_pose(random, lattice, corridor, height);
    corridor.update({known.grid}, voxel_at(lattice, start.position));
    const PathKey key{7, static_cast<std::uint64_t>(i), 0};
    const auto before = std::chrono::steady_clock::now();
    const PathPlan plan = plan_path(corridor, lattice, start, goal, key, options);
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count());
    ASSERT_TRUE(plan.found()) << name << ", pair " << i << ": the path " << describe(plan.outcome);
    fell_back += static_cast<int>(plan.outcome == PathOutcome::kFellBack);

    ASSERT_EQ(plan.viewpoints.front().position, start.position);
    ASSERT_EQ(plan.viewpoints.back().position, goal.position);
    ASSERT_EQ(plan.viewpoints.front().yaw, start.yaw);
    ASSERT_EQ(plan.viewpoints.back().yaw, goal.yaw);
    for (std::size_t k = 1; k < plan.viewpoints.size(); ++k)
      ASSERT_LE((plan.viewpoints[k].position - plan.viewpoints[k - 1].position).norm(), 1.2 * (1 + 1e-9));
    expect_free(known.grid, plan, box);
    if (testing::Test::HasFatalFailure()) return;

    if (i % 10 == 0) {  // the same key, the same path
      const PathPlan again = plan_path(corridor, lattice, start, goal, key, options);
      ASSERT_EQ(again.viewpoints.size(), plan.viewpoints.size());
      for (std::size_t k = 0; k < plan.viewpoints.size(); ++k) {
        ASSERT_EQ(again.viewpoints[k].position, plan.viewpoints[k].position);
        ASSERT_EQ(again.viewpoints[k].yaw, plan.viewpoints[k].yaw);
      }
    }
    // Two ends off the centres of their cells are all that can make it longer than from cell to cell.
    const double shortest = *corridor.distance(voxel_at(lattice, goal.position)) + 2 * kResolution;
    if (plan.outcome == PathOutcome::kFellBack || options.search == PathSearch::kCorridor) {
      ASSERT_LE(plan.length, shortest);
    }
    ratios.push_back(plan.length / shortest);
  }
  std::printf(
      "%s, %s, %zu cells: %d paths, %.2f ms median, %.2f ms at 95 %%, %.2f ms longest; %d fell back; %.3f "
      "times the corridor's distance and two voxels in the median, %.3f at 95 %%\n",
      name.c_str(), std::string(planner::name_of(options.search)).c_str(), corridor.cells().size(), pairs,
      at_part(times, 0.5), at_part(times, 0.95), at_part(times, 1.0), fell_back, at_part(ratios, 0.5),
      at_part(ratios, 0.95));
}

void check_world(const std::string& name, int pairs, std::initializer_list<PathSearch> searches) {
  const KnownWorld known(name);
  for (const PathSearch search : searches) {
    PathOptions options;
    options.search = search;
    if (search == PathSearch::kRrtStar) options.iterations = 2000;
    check_pairs(name + " ugv", known, ugv_travel(), 0.75, {2, 2, 0}, options, pairs);
    check_pairs(name + " uav", known, uav_travel(), 0.0, {1, 1, 1}, options, pairs);
  }
}

TEST(PathWorlds, PathsAreFreeExactAndRepeat) {
  check_world("room", 40, {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kCorridor});
  check_world("storage", 20, {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kCorridor});
}

class PathWorldsLong : public testing::TestWithParam<const char*> {};

TEST_P(PathWorldsLong, AThousandPathsAreFreeExactAndRepeat) {
  check_world(GetParam(), 1000, {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kCorridor});
  check_world(GetParam(), 20, {PathSearch::kRrtStar});
}
INSTANTIATE_TEST_SUITE_P(Worlds, PathWorldsLong,
                         testing::Values("maze", "factory", "station", "storage", "room"),
                         [](const auto& world) { return std::string(world.param); });

}  // namespace
}  // namespace frontlux::planner
