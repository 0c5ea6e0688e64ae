#include "planner/path/walled_space.hpp"
#include "support/complaint.hpp"

#include <frontlux/planner/path_planner.hpp>

#include <ompl/util/Console.h>

#include <future>

namespace frontlux::planner {
namespace {

constexpr double kResolution = 0.3;
constexpr std::array kSearches = {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kRrtStar,
                                  PathSearch::kCorridor};

using test::key_at;

// 24 x 24 x 11 voxels over a floor, and what a test puts there.
struct Scene : test::WalledSpace {
  Scene() : WalledSpace(24, 11, kResolution) {}
  void fill(const std::array<int, 3>& low, const std::array<int, 3>& high, Occupancy state) {
    test::fill(grid, {key_at(low[0], low[1], low[2]), key_at(high[0], high[1], high[2])}, state);
  }
  void wall(const std::array<int, 3>& low, const std::array<int, 3>& high) {
    fill(low, high, Occupancy::kOccupied);
  }
};

Pose pose(double x, double y, double z, double yaw = 0.0) { return {{x, y, z}, yaw}; }

bool same_bits(const Pose& a, const Pose& b) {
  const auto bits = [](double number) { return std::bit_cast<std::uint64_t>(number); };
  return bits(a.position.x()) == bits(b.position.x()) && bits(a.position.y()) == bits(b.position.y()) &&
         bits(a.position.z()) == bits(b.position.z()) && bits(a.yaw) == bits(b.yaw);
}

bool same_bits(const PathPlan& a, const PathPlan& b) {
  return a.outcome == b.outcome && a.iterations == b.iterations &&
         std::ranges::equal(a.viewpoints, b.viewpoints,
                            [](const Pose& p, const Pose& q) { return same_bits(p, q); });
}

void expect_free(const Scene& scene, const PathPlan& plan, const test::BodyBox& body) {
  test::expect_free(scene.grid, plan.viewpoints, body, 100);
}

// Two rooms, joined around the end of a wall.
Scene two_rooms() {
  Scene scene;
  scene.wall({11, 0, 0}, {12, 17, 10});
  return scene;
}

TEST(PathPlanner, GoesAroundAWallWithEachSearchAndBothRobots) {
  const Scene scene = two_rooms();
  const TravelCorridor ground = scene.corridor(ugv_travel(), key_at(4, 4, 2)),
                       air = scene.corridor(uav_travel(), key_at(4, 4, 5));
  for (const PathSearch search : kSearches) {
    PathOptions options;
    options.search = search;
    if (search == PathSearch::kRrtStar) options.iterations = 1500;  // it uses them all
    const Pose ugv_start = pose(1.41, 1.37, 0.75, 0.3), ugv_goal = pose(5.17, 1.5, 0.75, -2.0);
    const PathPlan ugv = plan_path(ground, scene.grid.lattice(), ugv_start, ugv_goal, {1, 2, 3}, options);
    EXPECT_EQ(ugv.outcome, PathOutcome::kFound) << name_of(search);
    ASSERT_GE(ugv.viewpoints.size(), 3U);
    EXPECT_TRUE(same_bits(ugv.viewpoints.front(), ugv_start));
    EXPECT_TRUE(same_bits(ugv.viewpoints.back(), ugv_goal));
    expect_free(scene, ugv, {2, 2, 0});
    for (const Pose& viewpoint : ugv.viewpoints) EXPECT_EQ(viewpoint.position.z(), 0.75);
    // Around the wall's end, grown by the box: no path is shorter than these three straight parts.
    const double least =
        std::hypot(9 * 0.3 - 1.41, 20 * 0.3 - 1.37) + 6 * 0.3 + std::hypot(0.3, 20 * 0.3 - 1.5);
    EXPECT_GT(ugv.length, least - 0.35) << name_of(search);
    EXPECT_LT(ugv.length, 1.15 * least) << name_of(search);

    const Pose uav_start = pose(1.41, 1.37, 1.61), uav_goal = pose(5.17, 1.5, 2.4);
    const PathPlan uav = plan_path(air, scene.grid.lattice(), uav_start, uav_goal, {1, 2, 4}, options);
    EXPECT_EQ(uav.outcome, PathOutcome::kFound) << name_of(search);
    EXPECT_TRUE(same_bits(uav.viewpoints.front(), uav_start));
    EXPECT_TRUE(same_bits(uav.viewpoints.back(), uav_goal));
    expect_free(scene, uav, {1, 1, 1});
    double length = 0.0;
    for (std::size_t i = 1; i < uav.viewpoints.size(); ++i) {
      const double step = (uav.viewpoints[i].position - uav.viewpoints[i - 1].position).norm();
      EXPECT_LE(step, options.spacing * (1 + 1e-9));
      length += step;
    }
    EXPECT_DOUBLE_EQ(uav.length, length);
    EXPECT_EQ(uav.iterations == 0, search == PathSearch::kCorridor);
  }
}

TEST(PathPlanner, LooksWhereItGoes) {
  const Scene scene = two_rooms();
  const TravelCorridor corridor = scene.corridor(uav_travel(), key_at(4, 4, 5));
  const PathPlan plan =
      plan_path(corridor, scene.grid.lattice(), pose(1.4, 1.4, 1.6, 3.0), pose(5.2, 1.5, 2.4, -3.0), {});
  ASSERT_GE(plan.viewpoints.size(), 4U);
  for (std::size_t i = 1; i + 1 < plan.viewpoints.size(); ++i) {
    const Eigen::Vector3d on = plan.viewpoints[i + 1].position - plan.viewpoints[i].position;
    const double across =
        std::cos(plan.viewpoints[i].yaw) * on.y() - std::sin(plan.viewpoints[i].yaw) * on.x();
    const double along =
        std::cos(plan.viewpoints[i].yaw) * on.x() + std::sin(plan.viewpoints[i].yaw) * on.y();
    EXPECT_NEAR(across, 0.0, 1e-12);
    EXPECT_GT(along, 0.0);
  }
  // Straight up there is no direction: the yaw stays.
  const PathPlan up =
      plan_path(corridor, scene.grid.lattice(), pose(1.4, 1.4, 1.3, 0.5), pose(1.4, 1.4, 2.7, -1.0), {});
  ASSERT_EQ(up.viewpoints.size(), 3U);
  EXPECT_EQ(up.viewpoints[1].yaw, 0.5);
  EXPECT_DOUBLE_EQ(up.viewpoints[1].position.z(), 2.0);
}

TEST(PathPlanner, RepeatsWithTheSameKeyInAnyOrderAndThread) {
  const Scene scene = two_rooms();
  const TravelCorridor corridor = scene.corridor(uav_travel(), key_at(4, 4, 5));
  for (const PathSearch search : {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kRrtStar}) {
    PathOptions options;
    options.search = search;
    if (search == PathSearch::kRrtStar) options.iterations = 500;
    options.shortcut_rounds = 0;  // shortening makes many paths equal
    const auto plan = [&](std::uint64_t seed, std::uint64_t step, std::uint64_t robot) {
      return plan_path(corridor, scene.grid.lattice(), pose(1.4, 1.4, 1.6), pose(5.2, 1.5, 2.4),
                       {seed, step, robot}, options);
    };
    const PathPlan first = plan(1, 0, 0);
    EXPECT_EQ(first.outcome, PathOutcome::kFound) << name_of(search);
    int differing = 0;
    for (std::uint64_t i = 0; i < 8; ++i) {
      differing += static_cast<int>(!same_bits(plan(2 + i, 0, 0), first));
      differing += static_cast<int>(!same_bits(plan(1, 1 + i, 0), first));
      differing += static_cast<int>(!same_bits(plan(1, 0, 1 + i), first));
      EXPECT_TRUE(same_bits(plan(1, 0, 0), first)) << name_of(search);
    }
    EXPECT_EQ(differing, 24) << name_of(search);
    std::vector<std::future<PathPlan>> threads;
    for (int i = 0; i < 4; ++i) threads.push_back(std::async(std::launch::async, plan, 1, 0, 0));
    for (auto& thread : threads) EXPECT_TRUE(same_bits(thread.get(), first)) << name_of(search);
  }
}

TEST(PathPlanner, FallsBackOnTheCorridorInANarrowPassage) {
  // A tunnel of just one cell, with two bends, in a block of rock.
  Scene scene;
  scene.wall({8, 0, 0}, {16, 23, 10});
  scene.fill({8, 4, 0}, {11, 8, 2}, Occupancy::kFree);
  scene.fill({9, 4, 0}, {13, 18, 2}, Occupancy::kFree);
  scene.fill({13, 14, 0}, {16, 18, 2}, Occupancy::kFree);
  const TravelCorridor corridor = scene.corridor(ugv_travel(), key_at(4, 4, 2));
  PathOptions options;
  options.iterations = 20;  // too few for a random search
  const Pose start = pose(0.95, 5.9, 0.7), goal = pose(5.9, 0.95, 0.8);
  for (const PathSearch search : {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kRrtStar}) {
    options.search = search;
    const PathPlan plan = plan_path(corridor, scene.grid.lattice(), start, goal, {}, options);
    EXPECT_EQ(plan.outcome, PathOutcome::kFellBack) << name_of(search);
    EXPECT_EQ(plan.iterations, 20);
    ASSERT_TRUE(plan.found());
    EXPECT_TRUE(same_bits(plan.viewpoints.front(), start));
    EXPECT_TRUE(same_bits(plan.viewpoints.back(), goal));
    expect_free(scene, plan, {2, 2, 0});
    EXPECT_LE(plan.length, *corridor.distance(key_at(19, 3, 2)) + *corridor.distance(key_at(3, 19, 2)));
    test::expect_parts(std::string(describe(plan.outcome)), {"corridor"});
  }
  // With enough iterations the search gets through, too.
  options = {};
  options.iterations = 20'000;
  const PathPlan plan = plan_path(corridor, scene.grid.lattice(), start, goal, {}, options);
  EXPECT_EQ(plan.outcome, PathOutcome::kFound);
  expect_free(scene, plan, {2, 2, 0});
}

TEST(PathPlanner, FallsBackOnACorridorThatDoesNotKnowItsCells) {
  test::WalledSpace scene(64, 11, kResolution);
  test::fill(scene.grid, {key_at(31, 0, 0), key_at(32, 50, 10)}, Occupancy::kOccupied);
  const Pose start = pose(1.41, 1.37, 1.61), goal = pose(17.2, 1.5, 2.4);
  const VoxelKey goal_cell = *scene.grid.lattice().key(goal.position);
  TravelCorridor corridor = scene.corridor(uav_travel(), key_at(4, 4, 5));
  const double shortest = corridor.distance(goal_cell).value();
  corridor.update({scene.grid}, key_at(4, 4, 5), CorridorExtent::kNearby);
  ASSERT_TRUE(corridor.cells().empty());
  ASSERT_FALSE(corridor.contains(goal_cell)) << "it is near";
  ASSERT_TRUE(corridor.find_path(goal_cell, [](const VoxelKey&) { return true; }));
  for (const PathSearch search : {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kRrtStar}) {
    PathOptions options;
    options.search = search;
    const PathPlan plan = plan_path(corridor, scene.grid.lattice(), start, goal, {}, options);
    EXPECT_EQ(plan.outcome, PathOutcome::kFellBack) << name_of(search);
    ASSERT_TRUE(plan.found());
    test::expect_free(scene.grid, plan.viewpoints, {1, 1, 1}, 100);
    EXPECT_LE(plan.length, shortest + kResolution);
  }
}

TEST(PathPlanner, SaysWhyThereIsNone) {
  Scene scene;
  scene.wall({11, 0, 0}, {12, 23, 10});  // from side to side
  const TravelCorridor corridor = scene.corridor(uav_travel(), key_at(4, 4, 5));
  const Lattice& lattice = scene.grid.lattice();
  const Pose here = pose(1.4, 1.4, 1.6), beyond = pose(5.5, 1.4, 1.6), in_wall = pose(3.5, 1.4, 1.6),
             beside_wall = pose(3.2, 1.4, 1.6), far = pose(1e6, 0.0, 1.6), low = pose(1.4, 1.4, 0.9);
  const auto outcome = [&](const Pose& from, const Pose& to) {
    const PathPlan plan = plan_path(corridor, lattice, from, to, {});
    EXPECT_FALSE(plan.found());
    EXPECT_EQ(plan.length, 0.0);
    return plan.outcome;
  };
  EXPECT_EQ(outcome(in_wall, here), PathOutcome::kStartNotFree);
  EXPECT_EQ(outcome(beside_wall, here), PathOutcome::kStartNotFree);
  EXPECT_EQ(outcome(here, in_wall), PathOutcome::kGoalNotFree);
  EXPECT_EQ(outcome(here, beside_wall), PathOutcome::kGoalNotFree);
  EXPECT_EQ(outcome(here, far), PathOutcome::kGoalNotFree);
  EXPECT_EQ(outcome(far, here), PathOutcome::kStartNotFree);
  EXPECT_EQ(outcome(here, low), PathOutcome::kGoalNotFree);
  EXPECT_EQ(outcome(here, beyond), PathOutcome::kOutOfReach);
  EXPECT_EQ(outcome(beyond, here), PathOutcome::kOutOfReach);

  const PathPlan turn = plan_path(corridor, lattice, here, pose(1.4, 1.4, 1.6, 2.0), {});
  EXPECT_EQ(turn.outcome, PathOutcome::kInPlace);
  ASSERT_EQ(turn.viewpoints.size(), 2U);
  EXPECT_EQ(turn.viewpoints[1].yaw, 2.0);
  EXPECT_EQ(turn.length, 0.0);

  const TravelCorridor unseen(uav_travel(), lattice, scene.bounds);
  EXPECT_EQ(plan_path(unseen, lattice, here, here, {}).outcome, PathOutcome::kNoCorridor);
  const TravelCorridor stuck = scene.corridor(uav_travel(), key_at(11, 4, 5));
  EXPECT_EQ(plan_path(stuck, lattice, here, beside_wall, {}).outcome, PathOutcome::kNoCorridor);
}

TEST(PathPlanner, RefusesNumbersAndOptionsThatAreNotValid) {
  const Scene scene;
  const TravelCorridor corridor = scene.corridor(uav_travel(), key_at(4, 4, 5));
  const Lattice& lattice = scene.grid.lattice();
  const Pose here = pose(1.4, 1.4, 1.6), there = pose(5.5, 1.4, 1.6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, std::numeric_limits<double>::infinity()})
    for (int i = 0; i < 4; ++i) {
      Pose broken = there;
      (i < 3 ? broken.position[i] : broken.yaw) = bad;
      EXPECT_REFUSED(plan_path(corridor, lattice, here, broken, {}));
      EXPECT_REFUSED(plan_path(corridor, lattice, broken, here, {}));
      EXPECT_FALSE(i < 3 && segment_is_free(corridor, lattice, here.position, broken.position));
    }
  const auto refused = [&](auto change) {
    PathOptions options;
    change(options);
    EXPECT_REFUSED(plan_path(corridor, lattice, here, there, {}, options));
  };
  refused([](PathOptions& o) { o.iterations = 0; });
  refused([](PathOptions& o) { o.iterations = 2'000'000; });
  refused([](PathOptions& o) { o.range = 0.0; });
  refused([&](PathOptions& o) { o.range = nan; });
  refused([](PathOptions& o) { o.spacing = -1.0; });
  refused([&](PathOptions& o) { o.spacing = nan; });
  refused([](PathOptions& o) { o.goal_bias = 1.01; });
  refused([&](PathOptions& o) { o.goal_bias = nan; });
  refused([](PathOptions& o) { o.shortcut_rounds = -1; });
  const TravelCorridor nodes = scene.corridor(uav_node_travel(), key_at(6, 6, 6));
  EXPECT_REFUSED(plan_path(nodes, lattice, here, there, {}));
}

TEST(PathPlanner, PlansBetweenPlacesThatAreNotTheRobots) {
  // The corridor begins in the left room; start and goal lie in side rooms of the other one.
  Scene scene = two_rooms();
  scene.wall({13, 8, 0}, {20, 9, 10});
  const TravelCorridor corridor = scene.corridor(ugv_travel(), key_at(4, 4, 2));
  PathOptions options;
  options.search = PathSearch::kCorridor;
  const PathPlan plan =
      plan_path(corridor, scene.grid.lattice(), pose(1.0, 5.0, 0.7), pose(5.2, 4.1, 0.8), {}, options);
  ASSERT_TRUE(plan.found());
  expect_free(scene, plan, {2, 2, 0});
  EXPECT_LT(plan.length, 7.5);  // not past the robot, which is 4 m off
  for (std::size_t i = 1; i < plan.viewpoints.size(); ++i)
    EXPECT_GE(plan.viewpoints[i].position.z(), plan.viewpoints[i - 1].position.z());
}

class Listener : public ompl::msg::OutputHandler {
 public:
  void log(const std::string& text, ompl::msg::LogLevel, const char*, int) override { heard.push_back(text); }
  std::vector<std::string> heard;
};

TEST(PathPlanner, PrintsNothingAndLeavesOmplAsItWas) {
  const Scene scene = two_rooms();
  const TravelCorridor corridor = scene.corridor(uav_travel(), key_at(4, 4, 5));
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const ompl::msg::LogLevel level = ompl::msg::getLogLevel();
  Listener before, now;
  ompl::msg::OutputHandler* const standard = ompl::msg::getOutputHandler();
  const auto plan_all = [&] {
    for (const PathSearch search : kSearches)
      for (const int iterations : {3, 500}) {
        PathOptions options;
        options.search = search;
        options.iterations = iterations;
        (void)plan_path(corridor, scene.grid.lattice(), pose(1.4, 1.4, 1.6), pose(5.2, 1.5, 2.4), {},
                        options);
      }
  };
  plan_all();
  EXPECT_EQ(ompl::msg::getOutputHandler(), standard);
  ompl::msg::useOutputHandler(&before);
  ompl::msg::useOutputHandler(&now);
  ompl::msg::setLogLevel(ompl::msg::LOG_DEV2);
  plan_all();
  EXPECT_EQ(ompl::msg::getLogLevel(), ompl::msg::LOG_DEV2);
  EXPECT_EQ(ompl::msg::getOutputHandler(), &now);
  EXPECT_TRUE(now.heard.empty() && before.heard.empty());
  OMPL_INFORM("again");
  EXPECT_EQ(now.heard, std::vector<std::string>{"again"});
  ompl::msg::restorePreviousOutputHandler();
  EXPECT_EQ(ompl::msg::getOutputHandler(), &before);
  ompl::msg::useOutputHandler(standard);
  ompl::msg::setLogLevel(level);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace frontlux::planner
