// Several robots in motion: they keep apart, and what a lost one was to see becomes the others'.

#include "planner/exploration/team_in_motion.hpp"

#include "sim/mesh/box_mesh.hpp"
#include "support/maps.hpp"

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::share_mapped;
using test::small_uav;
using test::TeamInMotion;

constexpr double kSample = 0.01;  // [s]

class TeamInMotionBy : public testing::TestWithParam<GoalChoice> {};
INSTANTIATE_TEST_SUITE_P(Each, TeamInMotionBy, testing::ValuesIn(test::kGoalChoices), test::name_of_choice);

void expect_apart(std::size_t count, double seconds, GoalChoice choice) {
  TeamInMotion scene("room", std::vector<RobotDescription>(count, small_uav()), sim::AtContact::kGoOn,
                     choice);
  const Eigen::AlignedBox3d body = body_of(small_uav().robot.travel);
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](double from, double to) {
    for (double time = from; time < to; time += kSample)
      for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a + 1; b < count; ++b) {
          const auto at = [&](std::size_t r) {
            return body.translated(scene.exploration().at(r, time).pose.position);
          };
          least = std::min(least, at(a).exteriorDistance(at(b)));
        }
  };
  scene.explore(seconds, {}, look);
  EXPECT_GT(least, 0.3);
  EXPECT_LT(least, 3.0) << "they are never near each other";
  for (std::size_t r = 0; r < count; ++r) EXPECT_GT(scene.robots().records()[r].length, 1.0);
}
TEST_P(TeamInMotionBy, KeepsTwoRobotsApart) { expect_apart(2, 20.0, GetParam()); }
TEST_P(TeamInMotionBy, KeepsThreeRobotsApart) { expect_apart(3, 12.0, GetParam()); }

TEST_P(TeamInMotionBy, LeavesToTheOthersWhatALostRobotWasToSee) {
  TeamInMotion scene("room", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GetParam());
  ContinuousExploration& exploration = scene.exploration();
  scene.explore(5.0);
  const double before = share_mapped(scene.team(), scene.grid());
  ASSERT_LT(before, 0.95);
  const Pose rests = exploration.at(1, scene.time()).pose;
  exploration.lose(1, rests, scene.time());
  const Eigen::AlignedBox3d body = body_of(small_uav().robot.travel);
  double least = std::numeric_limits<double>::infinity();
  scene.explore(
      300.0, [&](const PlannedMotion& now) { EXPECT_EQ(now.robot, 0U); },
      [&](double from, double to) {
        for (double time = from; time < to; time += kSample)
          least = std::min(least, body.translated(exploration.at(0, time).pose.position)
                                      .exteriorDistance(body.translated(rests.position)));
      });
  EXPECT_TRUE(exploration.end());
  EXPECT_TRUE(test::same(exploration.at(1, scene.time()).pose, rests));
  EXPECT_GT(share_mapped(scene.team(), scene.grid()), 0.98);
  EXPECT_GT(least, 0.3);
}

// One robot above or beside another one, nearer than robots keep apart: each goes its own way.
TEST_P(TeamInMotionBy, RobotsThatStartTooNearGoApart) {
  for (const Eigen::Vector3d& offset : {Eigen::Vector3d(0.9, 0, 0), Eigen::Vector3d(0, -0.9, 0),
                                        Eigen::Vector3d(0, 0, 0.9), Eigen::Vector3d(0.6, 0.9, 0.3)}) {
    test::TeamInWorld team("room", 1, {small_uav(), small_uav()});
    Pose beside = team.starts[0].pose;
    beside.position += offset;
    team.starts[1] = {beside, sim::start_bubble(team.truth, small_uav().robot, beside)};
    ASSERT_FALSE(sim::obstacle_at(team.truth, small_uav().robot, beside));
    TeamInMotion scene(std::move(team), sim::AtContact::kGoOn, GetParam());
    scene.explore(200.0);
    EXPECT_GT(share_mapped(scene.team(), scene.grid()), 0.98) << offset.transpose();
    EXPECT_GT(scene.robots().records()[0].length + scene.robots().records()[1].length, 5.0);
  }
}

// A robot that fails in the way of another one, as near as it can stop: it does not go on through it.
TEST_P(TeamInMotionBy, DoesNotGoOnThroughARobotThatFails) {
  constexpr double kAhead = 1.4, kFar = 2.0;  // [s], [m]
  const Eigen::AlignedBox3d body = body_of(small_uav().robot.travel);
  std::size_t failures = 0;
  const double step = test::long_mode() ? 0.4 : 0.7;  // [s]
  for (double time = 1.0; time < 9.0; time += step) {
    TeamInMotion scene("room", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GetParam());
    ContinuousExploration& exploration = scene.exploration();
    scene.explore(time);
    const Pose ahead = exploration.at(0, scene.time() + kAhead).pose;
    if ((ahead.position - exploration.at(0, scene.time()).pose.position).norm() < kFar) continue;
    ++failures;
    exploration.lose(1, ahead, scene.time());
    double least = std::numeric_limits<double>::infinity();
    scene.explore(time + 6.0, {}, [&](double from, double to) {
      for (double at = from; at < to; at += kSample)
        least = std::min(least, body.translated(exploration.at(0, at).pose.position)
                                    .exteriorDistance(body.translated(ahead.position)));
    });
    EXPECT_GT(least, 0.0) << time;
  }
  EXPECT_GT(failures, 2U);
}

// What a robot has for itself is worth nothing to it by so large an epsilon; with what it takes over from one
// that is lost it may be.
TEST_P(TeamInMotionBy, ALossIsNoEnd) {
  constexpr double kEpsilon = 60.0;
  std::size_t losses = 0;
  for (const double time : {3.0, 4.0, 5.0, 6.0, 7.0, 14.5}) {
    TeamInMotion scene(test::TeamInWorld("room", 1, {small_uav(), small_uav()}), sim::AtContact::kGoOn,
                       GetParam(), kEpsilon);
    ContinuousExploration& exploration = scene.exploration();
    scene.explore(time);
    if (exploration.end()) break;
    ++losses;
    exploration.lose(1, exploration.at(1, scene.time()).pose, scene.time());
    EXPECT_FALSE(exploration.end()) << "lost after " << time << " s";
  }
  EXPECT_GT(losses, 2U);
}

TEST_P(TeamInMotionBy, ALostRobotHasNoGoal) {
  TeamInMotion scene(test::TeamInWorld("room", 1, {small_uav(), small_uav()}), sim::AtContact::kGoOn,
                     GetParam());
  scene.explore(4.0);
  ContinuousExploration& exploration = scene.exploration();
  exploration.lose(1, exploration.at(1, scene.time()).pose, scene.time());
  const std::size_t before = scene.steps.size();
  scene.explore(10.0);
  ASSERT_GT(scene.steps.size(), before + 3);
  for (std::size_t i = before; i < scene.steps.size(); ++i) {
    EXPECT_FALSE(scene.steps[i].robots[1].goal.pose) << i;
    EXPECT_EQ(scene.steps[i].robots[1].goal.assigned, 0U) << i;
  }
}

// Two rooms of 6 x 6 x 2.4 m with a corridor of 6 x 1.8 x 2 m between them: the x of its ends [m]. There a
// UAV cannot pass over a UGV.
constexpr double kCorridor[] = {6.0, 12.0};
sim::World two_rooms() {
  sim::World world{"two rooms", {}, {}, Eigen::Vector3d(3.0, 0.0, 0.5)};
  const auto block = [&](float x, float y, float z, float to_x, float to_y, float to_z) {
    sim::test::add_box(world.mesh, {Eigen::Vector3f(x, y, z), Eigen::Vector3f(to_x, to_y, to_z)});
  };
  constexpr float kEnd = 18.0F, kOut = 0.3F, kFrom = kCorridor[0], kTo = kCorridor[1];
  for (const float z : {-kOut - 0.05F, 2.35F})
    block(-kOut, -3.0F - kOut, z, kEnd + kOut, 3.0F + kOut, z + kOut);
  for (const float x : {-kOut, kEnd}) block(x, -3.0F - kOut, -0.05F, x + kOut, 3.0F + kOut, 2.35F);
  for (const float y : {-3.0F - kOut, 3.0F}) block(0.0F, y, -0.05F, kEnd, y + kOut, 2.35F);
  block(kFrom, -3.0F, -0.05F, kTo, -0.9F, 2.35F);
  block(kFrom, 0.9F, -0.05F, kTo, 3.0F, 2.35F);
  block(kFrom, -0.9F, 1.95F, kTo, 0.9F, 2.35F);
  world.bounds = sim::bounds_of(world.mesh);
  return world;
}

class TeamOnTours : public testing::TestWithParam<GoalChoice> {};
INSTANTIATE_TEST_SUITE_P(Each, TeamOnTours,
                         testing::Values(GoalChoice::kTours, GoalChoice::kToursInALargeMap),
                         test::name_of_choice);

// In the middle of the corridor rests a robot with next to no sight, which never has anything to do.
test::TeamInWorld team_with_a_robot_between() {
  RobotDescription blind = ugv_description();
  blind.robot.travel.require_ground = false;
  blind.robot.view = {FieldOfView::Shape::kCone, 0.5, 0.0, 0.5};
  blind.columns = 100;
  blind.rows = 1;
  test::TeamInWorld team(two_rooms(), {small_uav(), blind});
  Pose between = team.starts[1].pose;
  between.position.x() = (kCorridor[0] + kCorridor[1]) / 2;
  between.position = Lattice(0.3).exact_center(Lattice(0.3).key(between.position).value());
  team.starts[1] = {between, sim::start_bubble(team.truth, blind.robot, between)};
  return team;
}

// It has failed, and nobody gets past it: there is more to see, but nothing to do.
TEST_P(TeamInMotionBy, EndsWhereALostRobotIsInTheWay) {
  TeamInMotion scene(team_with_a_robot_between(), sim::AtContact::kGoOn, GetParam());
  scene.exploration().lose(1, scene.team().starts[1].pose, 0.0);
  scene.explore(200.0);
  EXPECT_EQ(scene.exploration().end(),
            GetParam() == GoalChoice::kGoals ? ExplorationEnd::kLowGain : ExplorationEnd::kNothingToDo);
  const double share = share_mapped(scene.team(), scene.grid());
  EXPECT_GT(share, 0.7) << "its own room, and what it sees of the rest from there";
  EXPECT_LT(share, 0.9);
  EXPECT_GT(scene.robots().records()[0].length, 5.0);
}

TEST_P(TeamOnTours, MakesRoomForWhoeverHasSomethingToSee) {
  TeamInMotion scene(team_with_a_robot_between(), sim::AtContact::kGoOn, GetParam());
  std::size_t moves = 0;
  scene.explore(300.0, [&](const PlannedMotion& now) {
    if (now.robot == 1 && now.trajectory.end() > now.trajectory.begin()) ++moves;
  });
  EXPECT_EQ(scene.exploration().end(), ExplorationEnd::kNothingToDo);
  EXPECT_EQ(moves, 1U);
  const double x = scene.exploration().at(1, scene.time()).pose.position.x();
  EXPECT_TRUE(x < kCorridor[0] || x > kCorridor[1]) << x;
  EXPECT_GT(share_mapped(scene.team(), scene.grid()), 0.98);
}

TEST(TeamInMotion, EndsWithItsLastRobot) {
  TeamInMotion scene("room", {small_uav(), small_uav()});
  ContinuousExploration& exploration = scene.exploration();
  scene.explore(1.0);
  for (const std::size_t robot : {1U, 0U}) {
    EXPECT_FALSE(exploration.end());
    exploration.lose(robot, exploration.at(robot, scene.time()).pose, scene.time());
  }
  EXPECT_EQ(exploration.end(), ExplorationEnd::kNothingToDo);
  EXPECT_FALSE(exploration.plan(scene.time() + 10.0));
}

// Where a planning takes so long that the first robot has a reason again before the last one had its turn.
TEST(TeamInMotion, EachHasItsTurnHoweverLongPlanningsTake) {
  TeamInMotion scene("room", std::vector<RobotDescription>(3, small_uav()), sim::AtContact::kGoOn,
                     GoalChoice::kTours);
  std::vector<int> plannings(3);
  double time = 0.0;
  for (int i = 0; i < 24; ++i, time += 0.6)
    if (const auto planned = scene.exploration().plan(time)) ++plannings[planned->robot];
  for (const int count : plannings) EXPECT_GE(count, 4);
}

// An obstacle is found on a robot's path while others pass near by: it brakes, and they keep away.
TEST(TeamInMotion, BrakesForObstaclesOnThePathsOfOthers) {
  int obstacles = 0;
  for (const double begin : {7.3, 7.4, 7.8, 8.2, 8.5, 9.0}) {
    TeamInMotion scene("room", std::vector<RobotDescription>(3, small_uav()), sim::AtContact::kGoOn,
                       GoalChoice::kTours);
    ContinuousExploration& exploration = scene.exploration();
    scene.explore(begin);
    while (exploration.plan(scene.time())) {
    }
    const double now = scene.time() + 0.02;
    for (std::size_t who = 0; who < 3; ++who) {
      const Pose pose = exploration.at(who, now).pose;
      const Eigen::Vector3d ahead = exploration.at(who, now + 1.4).pose.position;
      const VoxelGrid grid = scene.grid();
      const auto voxel = grid.lattice().key(ahead);
      ASSERT_TRUE(voxel);
      if (grid.at(*voxel) != Occupancy::kFree || (ahead - pose.position).norm() < 1.5) continue;
      const Eigen::Vector3f ray = (grid.lattice().exact_center(*voxel) - pose.position).cast<float>();
      for (int hit = 0; hit < 10; ++hit)
        exploration.insert(who, pose, {pose.position.cast<float>(), 10.0, {ray.normalized()}, {ray.norm()}});
      if (scene.grid().at(*voxel) != Occupancy::kOccupied) continue;
      ++obstacles;
      const auto gap = [&](std::size_t a, std::size_t b, double time) {
        const auto body = [&](std::size_t r) {
          return body_of(small_uav().robot.travel).translated(exploration.at(r, time).pose.position);
        };
        return body(a).exteriorDistance(body(b));
      };
      const std::array pairs = {std::pair(0UL, 1UL), std::pair(0UL, 2UL), std::pair(1UL, 2UL)};
      std::array<double, 3> allowed{};
      for (std::size_t i = 0; i < 3; ++i)
        allowed[i] = std::min(kSeparation, gap(pairs[i].first, pairs[i].second, now)) - 1e-6;
      for (double time = now; time < now + 3.0; time += 0.02) {
        while (exploration.plan(time)) {
        }
        for (std::size_t i = 0; i < 3; ++i)
          EXPECT_GE(gap(pairs[i].first, pairs[i].second, time), allowed[i]) << begin << ": " << time - now;
        EXPECT_NE(grid.lattice().key(exploration.at(who, time).pose.position), *voxel)
            << begin << ": robot " << who << " after " << time - now << " s";
      }
      break;
    }
  }
  EXPECT_GT(obstacles, 2);
}

}  // namespace
}  // namespace frontlux::planner
