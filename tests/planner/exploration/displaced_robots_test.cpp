// Robots in motion that are not where their trajectory has them, with nothing in their path: they plan anew
// from where they are.

#include "planner/exploration/team_in_motion.hpp"

#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::small_uav;
using test::TeamInMotion;

TEST(DisplacedRobots, PlanAnewFromWhereTheyAre) {
  TeamInMotion scene("room", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GoalChoice::kTours);
  scene.explore(2.0);
  ContinuousExploration& exploration = scene.exploration();
  while (exploration.plan(scene.time())) {
  }
  const double time = scene.time() + 0.5;
  const Pose late = exploration.at(0, time - 0.3).pose;
  ASSERT_GT((exploration.at(0, time).pose.position - late.position).norm(), 0.05) << "the robot moves";
  exploration.displaced(0, late, time);
  EXPECT_TRUE(test::same(exploration.at(0, time + 1.0).pose, late));
  EXPECT_TRUE(exploration.at(0, time + 1.0).velocity.isZero());
  const auto planned = exploration.plan(time);
  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->robot, 0U);
  EXPECT_EQ(planned->reason, PlanReason::kStopped);
  EXPECT_TRUE(planned->step.robots[0].blocked.empty());
  EXPECT_TRUE(planned->step.robots[0].goal.pose) << "its cell is still one of its corridor";
  EXPECT_TRUE(test::same(planned->trajectory.at(planned->trajectory.begin()).pose, late));
  EXPECT_GT(planned->trajectory.length(), 0.1);
  const auto again = exploration.plan(time);
  EXPECT_TRUE(!again || again->robot != 0) << "only once";
}

// Told twice a second that the robot is where it was 0.1 s ago. Each time a cell would be closed if it were
// told as a stop.
TEST(DisplacedRobots, ExploreAllThoughTheyLagBehind) {
  TeamInMotion scene("room", {small_uav()}, sim::AtContact::kGoOn, GoalChoice::kTours);
  ContinuousExploration& exploration = scene.exploration();
  int displaced = 0;
  for (double until = 0.5; until < 600.0 && !exploration.end(); until += 0.5) {
    scene.explore(until);
    if (exploration.end()) break;
    const Pose late = exploration.at(0, scene.time() - 0.1).pose;
    if (test::same(late, exploration.at(0, scene.time()).pose)) continue;  // it rests
    exploration.displaced(0, late, scene.time());
    ++displaced;
  }
  EXPECT_EQ(exploration.end(), ExplorationEnd::kNothingToDo);
  EXPECT_GT(displaced, 20);
  EXPECT_GT(test::share_mapped(scene.team(), scene.grid()), 0.95);
}

TEST(DisplacedRobots, StayOnTheirPlane) {
  TeamInMotion scene("room", {ugv_description()}, sim::AtContact::kGoOn, GoalChoice::kTours);
  scene.explore(2.0);
  ContinuousExploration& exploration = scene.exploration();
  const Pose here = exploration.at(0, scene.time()).pose;
  Pose lower = here;
  lower.position.z() -= 0.3;
  exploration.displaced(0, lower, scene.time());
  EXPECT_EQ(exploration.at(0, scene.time()).pose.position, here.position);
}

// A robot that cannot go on retreats as it came. It did not come through the wall to where its localization
// has jumped, whether it says that it has or only that it cannot go on.
void expect_no_retreat_through_walls(bool says_so) {
  RobotDescription robot = small_uav();
  robot.robot.travel.extents = {0.4, 0.4, 0.3};  // so small that its voxel may be occupied beside it
  TeamInMotion scene("maze", {robot}, sim::AtContact::kGoOn, GoalChoice::kTours);
  ContinuousExploration& exploration = scene.exploration();
  std::vector<Eigen::Vector3d> been;
  for (double until = 0.1; until < 9.0; until += 0.1) {
    scene.explore(until);
    been.push_back(exploration.at(0, scene.time()).pose.position);
  }
  const VoxelGrid grid = scene.grid();
  const auto is_free = [&](const VoxelKey& key) { return grid.at(key) == Occupancy::kFree; };
  // From all that is about the nearest place of its trail.
  const auto is_behind_a_wall = [&](const Eigen::Vector3d& place) {
    const auto off = [&](const Eigen::Vector3d& at) { return (at - place).norm(); };
    const double nearest = off(*std::ranges::min_element(been, {}, off));
    return std::ranges::all_of(been, [&](const Eigen::Vector3d& at) {
      return off(at) > nearest + 0.5 || !SegmentVoxels(grid.lattice(), at, place).all_of(is_free);
    });
  };
  const VoxelKey at = grid.lattice().key(been.back()).value();
  std::optional<Pose> beyond;
  for (const VoxelKey& key : keys_in(grid, Occupancy::kFree)) {
    const Eigen::Vector3d place = grid.lattice().exact_center(key);
    if (key.z == at.z && !beyond && is_behind_a_wall(place)) beyond = Pose{place, 0.0};
  }
  ASSERT_TRUE(beyond);
  const double time = scene.time() + 0.01;
  if (says_so) exploration.displaced(0, *beyond, time);
  exploration.stopped(0, *beyond, time, {});  // now it has no corridor
  const auto planned = exploration.plan(time);
  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->step.robots[0].goal.state, GoalState::kNoCorridor);
  EXPECT_EQ(planned->trajectory.length(), 0.0);
}

TEST(DisplacedRobots, DoNotRetreatThroughWalls) { expect_no_retreat_through_walls(true); }
TEST(StoppedRobots, DoNotRetreatThroughWalls) { expect_no_retreat_through_walls(false); }

}  // namespace
}  // namespace frontlux::planner
