// Robots in motion: what they explore, how they move, and that they keep apart.

#include "planner/exploration/team_in_motion.hpp"
#include "planner/motion/within_limits.hpp"
#include "support/complaint.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/planner/recorded_map.hpp>

#include <tbb/task_arena.h>

#include <regex>

namespace frontlux::planner {
namespace {

using test::expect_within;
using test::GoalChoice;
using test::share_mapped;
using test::small_uav;
using test::TeamInMotion;
using test::TeamInWorld;

constexpr double kSample = 0.01;  // [s]
constexpr double kLong = 300.0;   // [s]

double turn(double from, double to) { return std::remainder(to - from, 2 * std::numbers::pi); }

// The voxels that are not known to be free for a body on its trajectory.
std::set<VoxelKey> not_free(const Trajectory& trajectory, const TravelOptions& travel,
                            const VoxelGrid& grid) {
  std::set<VoxelKey> keys;
  for (double time = trajectory.begin(); time < trajectory.end() + kSample; time += kSample)
    for_each_key(test::voxels_at(travel, grid.lattice(), trajectory.at(time).pose.position),
                 [&](const VoxelKey& key) {
                   if (grid.at(key) != Occupancy::kFree) keys.insert(key);
                 });
  return keys;
}

class ContinuousExplorationBy : public testing::TestWithParam<GoalChoice> {};
INSTANTIATE_TEST_SUITE_P(Each, ContinuousExplorationBy, testing::ValuesIn(test::kGoalChoices),
                         test::name_of_choice);

TEST_P(ContinuousExplorationBy, MapsWhatLockStepMapsOnPathsThatAreFreeAndWithinLimits) {
  TeamInMotion scene("room", {small_uav()}, sim::AtContact::kGoOn, GetParam());
  const Robot& robot = scene.exploration().options().team[0].robot;
  std::optional<Trajectory> before;
  VoxelGrid grid_before = scene.grid();
  int planned = 0, in_flight = 0;
  std::set<PlanReason> reasons;
  scene.explore(kLong, [&](const PlannedMotion& now) {
    ++planned;
    reasons.insert(now.reason);
    EXPECT_EQ(now.reason == PlanReason::kStart, planned == 1);
    const Trajectory& trajectory = now.trajectory;
    if (before && trajectory.begin() == before->begin()) return;  // it keeps the one that it has
    SCOPED_TRACE(testing::Message() << "planning " << planned << ", " << name_of(now.reason));
    expect_within(trajectory, robot.limits);
    // It takes up the one before where that is by then, after the latency.
    EXPECT_NEAR(trajectory.begin(), now.step.time + 0.1, 1e-12);
    const MotionState here = trajectory.at(trajectory.begin());
    const MotionState there =
        before ? before->at(trajectory.begin()) : MotionState{scene.team().starts[0].pose};
    EXPECT_LT((here.pose.position - there.pose.position).norm(), 1e-9);
    EXPECT_LT((here.velocity - there.velocity).norm(), 1e-6);
    EXPECT_LT(std::abs(turn(here.pose.yaw, there.pose.yaw)), 1e-9);
    in_flight += here.velocity.norm() > 0.1 ? 1 : 0;
    // What is not free now was when the one before was planned, of which it is the rest.
    const VoxelGrid grid = scene.grid();
    for (const VoxelKey& key : not_free(trajectory, robot.travel, grid))
      EXPECT_EQ(grid_before.at(key), Occupancy::kFree);
    before = trajectory;
    grid_before = grid;
  });
  ASSERT_TRUE(scene.exploration().end());
  const VoxelGrid grid = scene.grid();
  EXPECT_GT(planned, 10);
  EXPECT_GT(in_flight, planned / 3) << "it hardly ever stops";
  EXPECT_GE(reasons.size(), 3U);
  EXPECT_EQ(scene.robots().records()[0].contacts.size(), 0U);
  EXPECT_GT(scene.robots().records()[0].clearance, 0.0);

  const TeamInWorld& team = scene.team();
  sim::SimulatedRobots bodies = team.bodies();
  Exploration lockstep(TeamInMotion::options(team), team.empty_map());
  lockstep.begin(team.starts, test::drive_by(bodies));
  while (!lockstep.end()) lockstep.step(test::drive_by(bodies));
  EXPECT_GE(share_mapped(team, grid), 0.99 * share_mapped(team, lockstep.mapping().grid()));
  EXPECT_GT(share_mapped(team, grid), 0.9);
}

// Also where it brakes and goes back on its way.
TEST_P(ContinuousExplorationBy, RecordsTrajectoriesToCentimetres) {
  TeamInMotion scene("room", {small_uav(), planner::ugv_description()}, sim::AtContact::kGoOn, GetParam());
  double most = 0.0;
  scene.explore(kLong, [&](const PlannedMotion& now) {
    const std::vector<Pose>& recorded = now.step.robots[now.robot].trajectory;
    ASSERT_FALSE(recorded.empty());
    const auto from_recorded = [&](const Eigen::Vector3d& place) {
      double least = (place - recorded.front().position).norm();
      for (std::size_t i = 1; i < recorded.size(); ++i) {
        const Eigen::Vector3d a = recorded[i - 1].position, way = recorded[i].position - a;
        const double part = std::clamp((place - a).dot(way) / std::max(way.squaredNorm(), 1e-12), 0.0, 1.0);
        least = std::min(least, (place - a - part * way).norm());
      }
      return least;
    };
    const double end = now.trajectory.end();
    for (double time = std::max(now.trajectory.begin(), now.step.time + 0.1); time < end; time += 0.02)
      most = std::max(most, from_recorded(now.trajectory.at(time).pose.position));
  });
  EXPECT_GT(most, 0.001);
  EXPECT_LT(most, 0.05);
}

// Steps tell all that happened: numbers, times, scans and changes.
TEST_P(ContinuousExplorationBy, StepsAddUpToTheMap) {
  TeamInMotion scene("room", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GetParam());
  scene.explore(6.0);
  scene.steps.push_back(scene.exploration().finish(scene.time()));
  RecordedMap map(0.3);
  std::vector<std::size_t> scans(2);
  std::vector<double> metres(2);
  for (std::size_t i = 0; i < scene.steps.size(); ++i) {
    const ExplorationStep& step = scene.steps[i];
    EXPECT_EQ(step.number, i);
    EXPECT_TRUE(i == 0 || step.time >= scene.steps[i - 1].time);
    map.apply({step, {}, 0});
    for (std::size_t r = 0; r < 2; ++r) {
      const RobotStep& robot = step.robots[r];
      EXPECT_EQ(robot.travelled, robot.planned.size());
      scans[r] += robot.planned.size() - 1;
      metres[r] += robot.length;
      if (i == 0 || robot.planned.empty()) continue;
      EXPECT_TRUE(test::same(robot.planned.front(), scene.steps[i - 1].robots[r].planned.back()));
    }
  }
  EXPECT_TRUE(map.grid() == scene.grid());
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_EQ(scans[r], 61U);  // ten a second, the first one at once
    // Chords between scans are a little shorter.
    EXPECT_NEAR(metres[r], scene.robots().records()[r].length, 0.03 * metres[r]);
    EXPECT_GT(metres[r], 1.0);
  }
}

// Each frontier of the map is a robot's, or unassigned, or abandoned.
TEST(ContinuousExploration, CountsTheFrontiersThatAreInNoTour) {
  TeamInMotion scene("room", {small_uav()}, sim::AtContact::kGoOn, GoalChoice::kTours);
  std::set<VoxelKey> own;
  std::size_t most_unassigned = 0;
  scene.explore(60.0, [&](const PlannedMotion& planned) {
    const ExplorationStep& step = planned.step;
    const RobotStep& robot = step.robots[0];
    for (const VoxelKey& key : robot.reassigned)
      if (!own.insert(key).second) own.erase(key);
    const std::size_t others = step.unassigned + step.abandoned;
    EXPECT_LE(others, step.frontiers);
    EXPECT_LE(step.frontiers, others + own.size()) << "some of its own may have been mapped since";
    if (!robot.reassigned.empty()) {
      EXPECT_EQ(step.frontiers, others + own.size());
    }
    most_unassigned = std::max(most_unassigned, step.unassigned);
  });
  const ExplorationStep& last = scene.steps.back();
  EXPECT_GT(most_unassigned, 0U);
  ASSERT_TRUE(scene.exploration().end());
  EXPECT_EQ(last.frontiers, last.unassigned + last.abandoned);
  const std::string& said = last.robots[0].goal.reason;
  const std::regex parts(
      "no goal: there is nothing to see for it; frontiers that are left: "
      "(\\d+) in clusters of fewer than 17"  // 1.5 m2
      "(?:, (\\d+) in clusters of which no robot sees 10 from where it can get to)?(?:, (\\d+) given up)?");
  std::smatch part;
  ASSERT_TRUE(std::regex_match(said, part, parts)) << said;
  const std::size_t unseen = part[2].matched ? std::stoul(part[2]) : 0;
  EXPECT_EQ(std::stoul(part[1]) + unseen, last.unassigned) << said;
  EXPECT_EQ(part[3].matched ? std::stoul(part[3]) : 0, last.abandoned) << said;
}

// A robot that keeps its goal weighs none.
TEST_P(ContinuousExplorationBy, TellsTheCandidatesAmongWhichGoalsAreChosen) {
  TeamInMotion scene("room", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GetParam());
  int chosen = 0;
  scene.explore(8.0, [&](const PlannedMotion& now) {
    for (std::size_t r = 0; r < 2; ++r) {
      const RobotStep& robot = now.step.robots[r];
      if (robot.image.empty()) continue;
      EXPECT_EQ(r, now.robot) << "the other one did not plan";
      if (!robot.goal.pose) continue;
      ++chosen;
      EXPECT_TRUE(std::ranges::binary_search(robot.image, robot.goal.cell, {}, &RenderedCell::cell));
      const double lambda = scene.exploration().options().team[r].options.lambda;
      for (const RenderedCell& cell : robot.image)
        EXPECT_LE(cell.quality, std::exp(-lambda * cell.distance) * cell.gain + 1e-9);
    }
  });
  EXPECT_GT(chosen, 4);
}

TEST_P(ContinuousExplorationBy, IsTheSameOnOneAndTwoThreads) {
  const auto told = [](int threads) {
    return tbb::task_arena(threads).execute([] {
      TeamInMotion scene("room", {small_uav(), planner::ugv_description()}, sim::AtContact::kGoOn,
                         GetParam());
      std::ostringstream text;
      text << std::hexfloat;
      scene.explore(4.0, [&](const PlannedMotion& now) {
        text << now.robot << ' ' << name_of(now.reason) << '\n' << test::listed(now.step);
        for (double time = now.trajectory.begin(); time < now.trajectory.end(); time += 0.1) {
          const MotionState state = now.trajectory.at(time);
          text << state.pose.position.transpose() << ' ' << state.pose.yaw << ' '
               << state.velocity.transpose() << ' ' << state.yaw_rate << '\n';
        }
      });
      return text.str() + test::bytes_of(scene.exploration().mapping());
    });
  };
  const std::string one = told(1);
  EXPECT_GT(one.size(), 100'000U);
  EXPECT_TRUE(one == told(2));
}

// A beam that ends in the middle of a voxel, or passes through it.
Scan beam(const Lattice& lattice, const VoxelKey& from, const VoxelKey& to, bool hit) {
  const Eigen::Vector3f origin = lattice.exact_center(from).cast<float>(),
                        way = lattice.exact_center(to).cast<float>() - origin;
  Scan scan;
  scan.origin = origin;
  scan.max_range = 10.0;
  scan.directions = {way.normalized()};
  scan.ranges = {hit ? way.norm() : std::numeric_limits<float>::infinity()};
  if (!hit) scan.max_range = way.norm();
  return scan;
}

// Beams that graze a surface free some of its voxels. What lies behind them is no frontier all the same. But
// it is if a single beam has ended there: it may have been a stray return.
TEST(ContinuousExploration, SeesNoFrontiersBehindSurfaces) {
  for (const bool is_surface : {true, false}) {
    const TeamInWorld team("room", 1, {small_uav()});
    ContinuousExploration exploration(TeamInMotion::options(team), team.empty_map());
    exploration.begin(team.starts, 0.0);
    const VoxelGrid& grid = exploration.mapping().grid();
    const Pose pose = team.starts[0].pose;
    const VoxelKey here = grid.lattice().key(pose.position).value();
    const auto at = [&](int x, int y) { return make_key(here.x + x, here.y + y, here.z); };
    const auto frontiers = [&] { return exploration.finish(1.0).frontiers; };
    const auto of_map = [&] { return FrontierSet(grid, exploration.mapping().bounds()).size(); };
    exploration.insert(0, pose, beam(grid.lattice(), here, at(5, 0), true));
    if (is_surface) exploration.insert(0, pose, beam(grid.lattice(), here, at(5, 0), true));
    ASSERT_EQ(grid.at(at(5, 0)), Occupancy::kOccupied);
    EXPECT_EQ(frontiers(), of_map());
    // From the side: at(5, 0) becomes free, and at(6, 0), which only it hides, stays unknown.
    for (int i = 0; i < 5; ++i) exploration.insert(0, pose, beam(grid.lattice(), at(5, -1), at(5, 2), false));
    ASSERT_EQ(grid.at(at(5, 0)), Occupancy::kFree);
    ASSERT_EQ(grid.at(at(6, 0)), Occupancy::kUnknown);
    const FrontierSet all(grid, exploration.mapping().bounds());
    ASSERT_TRUE(all.contains(at(6, 0)));
    VoxelGrid solid = grid;
    if (is_surface) solid.set(at(5, 0), Occupancy::kOccupied);
    const std::size_t seen = FrontierSet(solid, exploration.mapping().bounds()).size();
    EXPECT_EQ(seen < all.size(), is_surface);
    EXPECT_EQ(frontiers(), seen);
  }
}

// Where a robot starts there is nothing, whatever a map from before says.
TEST_P(ContinuousExplorationBy, BeginsWhereSomethingStoodBefore) {
  const TeamInWorld team("room", 1, {small_uav()});
  Mapping map = team.empty_map();
  const Eigen::Vector3f middle = team.starts[0].pose.position.cast<float>();
  map.insert(middle, {&middle, 1});
  ASSERT_EQ(map.grid().at(map.grid().lattice().key(middle).value()), Occupancy::kOccupied);
  ContinuousExploration exploration(TeamInMotion::options(team, GetParam()), std::move(map));
  exploration.begin(team.starts, 0.0);
  const auto planned = exploration.plan(0.0);
  ASSERT_TRUE(planned);
  EXPECT_TRUE(planned->step.robots[0].goal.pose) << planned->step.robots[0].goal.reason;
}

// A table that stands in the ball that a start takes for free: the map knows better. The account of all steps
// is the map, what was known before included.
TEST_P(ContinuousExplorationBy, BeginsWithAMapThatIsGiven) {
  const TeamInWorld team("room", 1, {small_uav()});
  Mapping map = team.empty_map();
  const Eigen::Vector3f middle = team.starts[0].pose.position.cast<float>();
  const Eigen::Vector3f table = middle + Eigen::Vector3f(0.0F, 0.0F, -0.9F);
  map.insert(middle, {{table, Eigen::Vector3f(middle + Eigen::Vector3f(2.1F, 0.0F, 0.0F))}});
  const VoxelKey on_table = map.grid().lattice().key(table).value();
  ASSERT_EQ(map.grid().at(on_table), Occupancy::kOccupied);
  const auto& bubble = team.starts[0].known_free;
  ASSERT_TRUE(std::ranges::find(bubble, on_table) != bubble.end());
  const VoxelGrid given = map.grid();
  ContinuousExploration exploration(TeamInMotion::options(team, GetParam()), std::move(map));
  VoxelGrid told(0.3);
  const auto take = [&](const ExplorationStep& step) {
    for (const RobotStep& robot : step.robots)
      for (const VoxelChange& change : robot.changed) {
        ASSERT_EQ(told.at(change.key), change.before);
        told.set(change.key, change.after);
      }
  };
  take(exploration.begin(team.starts, 0.0));
  EXPECT_TRUE(told == exploration.mapping().grid());
  EXPECT_EQ(told.at(on_table), Occupancy::kOccupied);
  EXPECT_GT(told.count()[1], given.count()[1]);
  exploration.insert(0, team.starts[0].pose, {middle, 5.0, {{0.0F, 1.0F, 0.0F}}, {4.0F}});
  take(exploration.finish(1.0));
  EXPECT_TRUE(told == exploration.mapping().grid());
}

// An account of what has been mapped takes nothing from the plannings after it.
TEST_P(ContinuousExplorationBy, GoesOnAfterAFinish) {
  TeamInMotion scene("room", {small_uav()}, sim::AtContact::kGoOn, GetParam());
  scene.explore(2.0);
  ContinuousExploration& exploration = scene.exploration();
  while (exploration.plan(scene.time())) {
  }
  const double time = scene.time() + 20.0;  // it has come to rest
  const Pose pose = exploration.at(0, time).pose;
  const Lattice lattice = scene.grid().lattice();
  const VoxelKey here = lattice.key(pose.position).value();
  for (int i = 0; i < 10; ++i)
    exploration.insert(0, pose, beam(lattice, here, make_key(here.x + 1, here.y, here.z), true));
  EXPECT_EQ(exploration.finish(time).time, time);
  const auto planned = exploration.plan(time + 1.0);
  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->step.robots[0].goal.state, GoalState::kNoCorridor);
}

TEST(ContinuousExploration, EndsAtItsLimitOfPlannings) {
  const TeamInWorld team("room", 1, {small_uav()});
  ExplorationOptions options = TeamInMotion::options(team);
  options.max_steps = 2;
  ContinuousExploration exploration(options, team.empty_map());
  EXPECT_FALSE(exploration.end());
  EXPECT_EQ(exploration.begin(team.starts, 7.0).time, 7.0);
  double time = 7.0;
  for (int i = 1; i <= 2; ++i, time += 2.0) {
    EXPECT_FALSE(exploration.end());
    const auto planned = exploration.plan(time);
    ASSERT_TRUE(planned);
    EXPECT_EQ(planned->step.number, static_cast<std::uint64_t>(i));
  }
  ASSERT_TRUE(exploration.end());
}

TEST(ContinuousExploration, RefusesWrongUse) {
  const TeamInWorld team("room", 1, {small_uav()});
  const double nan = std::nan("");
  const Pose pose = team.starts[0].pose;
  Scan scan;
  scan.origin = pose.position.cast<float>();
  ContinuousExploration exploration(TeamInMotion::options(team), team.empty_map());
  const auto refuses = [&](const auto& call, const std::string& part) {
    test::expect_complaint(call, {"continuous exploration: ", part});
  };
  refuses([&] { exploration.insert(0, pose, scan); }, "no robot 0");
  refuses([&] { exploration.stopped(0, pose, 0.0, {}); }, "no robot 0");
  refuses([&] { exploration.displaced(0, pose, 0.0); }, "no robot 0");
  refuses([&] { exploration.lose(0, pose, 0.0); }, "no robot 0");
  refuses([&] { static_cast<void>(exploration.at(0, 0.0)); }, "no robot 0");
  refuses([&] { static_cast<void>(exploration.plan(0.0)); }, "before its beginning");
  refuses([&] { static_cast<void>(exploration.finish(0.0)); }, "before its beginning");
  refuses([&] { exploration.begin({}, 0.0); }, "0 starts for 1 robots");
  ExplorationStart lost = team.starts[0];
  lost.pose.yaw = nan;
  EXPECT_REFUSED(exploration.begin({&lost, 1}, 0.0));
  EXPECT_REFUSED(exploration.begin(team.starts, nan));
  lost.pose = {{1e9, 0.0, 0.0}, 0.0};
  refuses([&] { exploration.begin({&lost, 1}, 0.0); }, "outside the map's key range");
  // Nothing of that has begun it.
  exploration.begin(team.starts, 0.0);
  refuses([&] { exploration.begin(team.starts, 0.0); }, "has begun already");
  refuses([&] { exploration.insert(1, pose, scan); }, "no robot 1");
  refuses([&] { static_cast<void>(exploration.at(1, 0.0)); }, "no robot 1");
  const Pose nowhere{lost.pose.position, nan};
  EXPECT_REFUSED(exploration.insert(0, nowhere, scan));
  EXPECT_REFUSED(exploration.stopped(0, nowhere, 0.0, {}));
  const Pose far{{1e5, 0.0, 0.0}, 0.0};
  refuses([&] { exploration.stopped(0, far, 0.0, {}); }, "outside the map's key range");
  refuses([&] { exploration.displaced(0, far, 0.0); }, "outside the map's key range");
  refuses([&] { exploration.lose(0, far, 0.0); }, "outside the map's key range");
  for (const double time : {nan, 1.7e15, -1.7e15}) {  // microseconds since 1970
    refuses([&] { static_cast<void>(exploration.plan(time)); }, "the time is ");
    refuses([&] { static_cast<void>(exploration.finish(time)); }, "the time is ");
    refuses([&] { exploration.stopped(0, pose, time, {}); }, "the time is ");
    refuses([&] { exploration.displaced(0, pose, time); }, "the time is ");
    refuses([&] { exploration.lose(0, pose, time); }, "the time is ");
  }
  ExplorationOptions options = TeamInMotion::options(team);
  for (double ExplorationOptions::*seconds :
       {&ExplorationOptions::latency, &ExplorationOptions::period, &ExplorationOptions::commitment})
    for (const double bad : {0.0, -1.0, nan}) {
      ExplorationOptions wrong = options;
      wrong.*seconds = bad;
      EXPECT_REFUSED(ContinuousExploration(wrong, team.empty_map()));
    }
  const auto wrong_if = [&](const auto& change) {
    ExplorationOptions wrong = options;
    change(wrong);
    EXPECT_REFUSED(ContinuousExploration(wrong, team.empty_map()));
  };
  wrong_if([](ExplorationOptions& wrong) { wrong.path.iterations = 0; });
  wrong_if([&](ExplorationOptions& wrong) { wrong.path.spacing = nan; });
  wrong_if([](ExplorationOptions& wrong) { wrong.path.search = static_cast<PathSearch>(99); });
  wrong_if([](ExplorationOptions& wrong) { wrong.team[0].robot.limits.speed = 1e-300; });
  wrong_if([](ExplorationOptions& wrong) { wrong.team[0].robot.view.max_range = -1.0; });
  wrong_if([&](ExplorationOptions& wrong) { wrong.team[0].options.lambda = nan; });
  EXPECT_EQ(name_of(PlanReason::kGoalSeen), "goal_seen");
  // Too large a map is found out at the beginning, with tours as without, as often as it begins.
  options.tours = true;
  ContinuousExploration anywhere(options, Mapping({.resolution = 0.3}));
  for (int i = 0; i < 2; ++i)
    test::expect_complaint([&] { anywhere.begin(team.starts, 0.0); }, {"give smaller bounds"});
}

TEST(TourOptions, AskAStopForTenFrontiersButNotForMoreOrLessThanAnArea) {
  for (const auto& [resolution, epsilon] :
       {std::pair(0.05, 120.0), {0.1, 30.0}, {0.2, 10.0}, {0.3, 10.0}, {0.5, 4.0}, {1.0, 1.0}, {3.0, 1.0}})
    EXPECT_EQ(tour_options(resolution).epsilon, epsilon) << resolution;
}

}  // namespace
}  // namespace frontlux::planner
