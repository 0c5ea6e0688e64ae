#include "planner/path/walled_space.hpp"
#include "support/random.hpp"

#include <frontlux/planner/path_planner.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground_truth.hpp>

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
    for_each_key(truth.bounds(), [this](const VoxelKey& key) {
      if (truth.contains(key))
        grid.set(key, truth.at(key) == sim::Truth::kFree ? Occupancy::kFree : Occupancy::kOccupied);
    });
  }
};

Pose random_pose(test::Random& random, const Lattice& lattice, const TravelCorridor& corridor,
                 double height) {
  const VoxelKey cell = random.pick(corridor.cells());
  Pose pose{lattice.exact_center(cell)};
  pose.position += random.point(-0.499, 0.499) * kResolution;
  if (height > 0.0) pose.position.z() = height;
  pose.yaw = random.uniform(-3.0, 3.0);
  return pose;
}

void check_pairs(const std::string& name, const KnownWorld& known, const TravelOptions& travel, double height,
                 const test::BodyBox& body, const PathOptions& options, int pairs) {
  const Lattice& lattice = known.grid.lattice();
  TravelCorridor corridor(travel, lattice, known.truth.bounds());
  Eigen::Vector3d robot = *known.world.start;
  robot.z() = height > 0.0 ? height : 1.35;
  corridor.update({known.grid}, lattice.key(robot).value());
  ASSERT_EQ(corridor.state(), CorridorState::kReady) << describe(corridor.state());

  test::Random random(5);
  for (int i = 0; i < pairs; ++i) {
    // A path may start where the body does not quite fit, as when the map has changed, but may not end there.
    const Pose start = random_pose(random, lattice, corridor, height);
    Pose goal = random_pose(random, lattice, corridor, height);
    while (!segment_is_free(corridor, lattice, goal.position, goal.position))
      goal = random_pose(random, lattice, corridor, height);
    corridor.update({known.grid}, lattice.key(start.position).value());
    const PathKey key{7, static_cast<std::uint64_t>(i), 0};
    const PathPlan plan = plan_path(corridor, lattice, start, goal, key, options);
    ASSERT_TRUE(plan.found()) << name << ", pair " << i << ": the path " << describe(plan.outcome);
    ASSERT_EQ(plan.viewpoints.front().position, start.position);
    ASSERT_EQ(plan.viewpoints.back().position, goal.position);
    ASSERT_EQ(plan.viewpoints.front().yaw, start.yaw);
    ASSERT_EQ(plan.viewpoints.back().yaw, goal.yaw);
    for (std::size_t k = 1; k < plan.viewpoints.size(); ++k)
      ASSERT_LE((plan.viewpoints[k].position - plan.viewpoints[k - 1].position).norm(), 1.2 * (1 + 1e-9));
    test::expect_free(known.grid, plan.viewpoints, body, 10);
    if (testing::Test::HasFatalFailure()) return;

    if (i % 10 == 0) {  // the same key, the same path
      const PathPlan again = plan_path(corridor, lattice, start, goal, key, options);
      ASSERT_EQ(again.viewpoints.size(), plan.viewpoints.size());
      for (std::size_t k = 0; k < plan.viewpoints.size(); ++k) {
        ASSERT_EQ(again.viewpoints[k].position, plan.viewpoints[k].position);
        ASSERT_EQ(again.viewpoints[k].yaw, plan.viewpoints[k].yaw);
      }
    }
    // Only its ends, which are off the centres of their cells, can make it longer than from cell to cell.
    if (plan.outcome == PathOutcome::kFellBack || options.search == PathSearch::kCorridor) {
      ASSERT_LE(plan.length, *corridor.distance(lattice.key(goal.position).value()) + 2 * kResolution);
    }
  }
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
