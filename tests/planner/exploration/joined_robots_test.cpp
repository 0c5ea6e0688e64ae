// Robots that come later than the others, or again.

#include "planner/exploration/team_in_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::share_mapped;
using test::small_uav;
using test::TeamInMotion;

class JoinedRobotsBy : public testing::TestWithParam<GoalChoice> {};
INSTANTIATE_TEST_SUITE_P(Each, JoinedRobotsBy, testing::ValuesIn(test::kGoalChoices), test::name_of_choice);

ExplorationStart rests_at(TeamInMotion& scene, std::size_t robot) {
  return {scene.exploration().at(robot, scene.time()).pose, {}};
}

// As if it had never been away.
TEST_P(JoinedRobotsBy, AtOnceMakesNoDifference) {
  const auto explored = [](bool away) {
    TeamInMotion scene("room", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GetParam());
    if (away) {
      scene.exploration().lose(1, scene.team().starts[1].pose, 0.0);
      scene.exploration().join(1, scene.team().starts[1], 0.0);
    }
    std::vector<std::tuple<std::size_t, PlanReason, Pose>> plannings;
    scene.explore(8.0, [&](const PlannedMotion& now) {
      plannings.emplace_back(now.robot, now.reason, now.trajectory.end_pose());
    });
    return plannings;
  };
  const auto expected = explored(false), found = explored(true);
  ASSERT_GT(expected.size(), 10U);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& [robot, reason, pose] = found[i];
    EXPECT_EQ(robot, std::get<0>(expected[i])) << i;
    EXPECT_EQ(reason, std::get<1>(expected[i])) << i;
    EXPECT_TRUE(test::same(pose, std::get<2>(expected[i]))) << i;
  }
}

TEST_P(JoinedRobotsBy, GetTheirShareAndKeepApart) {
  TeamInMotion scene("room", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GetParam());
  ContinuousExploration& exploration = scene.exploration();
  exploration.lose(1, scene.team().starts[1].pose, 0.0);
  scene.explore(3.0, [](const PlannedMotion& now) { EXPECT_EQ(now.robot, 0U); });
  ASSERT_LT(share_mapped(scene.team(), scene.grid()), 0.9);
  exploration.join(1, rests_at(scene, 1), scene.time());
  std::vector<PlanReason> reasons;
  std::size_t goals = 0;
  double least = std::numeric_limits<double>::infinity();
  const Eigen::AlignedBox3d body = body_of(small_uav().robot.travel);
  scene.explore(
      300.0,
      [&](const PlannedMotion& now) {
        if (now.robot != 1) return;
        reasons.push_back(now.reason);
        goals += now.step.robots[1].goal.pose.has_value() ? 1 : 0;
      },
      [&](double from, double to) {
        for (double time = from; time < to; time += 0.01)
          least =
              std::min(least, body.translated(exploration.at(0, time).pose.position)
                                  .exteriorDistance(body.translated(exploration.at(1, time).pose.position)));
      });
  ASSERT_FALSE(reasons.empty());
  EXPECT_EQ(reasons.front(), PlanReason::kStart);
  EXPECT_EQ(std::ranges::count(reasons, PlanReason::kStart), 1);
  EXPECT_GT(goals, 2U);
  EXPECT_GT(scene.robots().records()[1].length, 2.0);
  EXPECT_GT(share_mapped(scene.team(), scene.grid()), 0.98);
  EXPECT_TRUE(exploration.end());
  EXPECT_GT(least, 0.3);
}

// Rays end in all voxels of a robot that is not there yet: what they met has gone when it comes.
void see_something_at(TeamInMotion& scene, const Pose& pose) {
  const Lattice lattice = scene.grid().lattice();
  Scan scan{pose.position.cast<float>() - Eigen::Vector3f(1.5F, 0, 0), 10.0, {}, {}};
  for_each_key(test::voxels_at(small_uav().robot.travel, lattice, pose.position), [&](const VoxelKey& key) {
    const Eigen::Vector3f ray = lattice.center(key) - scan.origin;
    scan.directions.push_back(ray.normalized());
    scan.ranges.push_back(ray.norm());
  });
  for (int i = 0; i < 3; ++i) scene.exploration().insert(0, pose, scan);
}

// Carried to where nobody has been, with what is free around it; it does not go back to where it was.
TEST_P(JoinedRobotsBy, GoOnFromWhereverTheyAre) {
  TeamInMotion scene("maze", {small_uav(), small_uav()}, sim::AtContact::kGoOn, GetParam());
  ContinuousExploration& exploration = scene.exploration();
  scene.explore(4.0);
  exploration.lose(1, exploration.at(1, scene.time()).pose, scene.time());
  Pose elsewhere = scene.team().starts[0].pose;
  const Lattice lattice = scene.grid().lattice();
  const auto is_new = [&](const Pose& pose) {
    return scene.grid().at(lattice.key(pose.position).value()) == Occupancy::kUnknown &&
           !sim::obstacle_at(scene.team().truth, small_uav().robot, pose);
  };
  while (!is_new(elsewhere)) {
    elsewhere.position.x() += lattice.resolution();
    ASSERT_TRUE(scene.team().truth.bounds().contains(lattice.key(elsewhere.position).value()));
  }
  see_something_at(scene, elsewhere);
  exploration.join(1, {elsewhere, sim::start_bubble(scene.team().truth, small_uav().robot, elsewhere)},
                   scene.time());
  EXPECT_TRUE(test::same(exploration.at(1, scene.time()).pose, elsewhere));
  auto planned = exploration.plan(scene.time());
  while (planned && planned->robot != 1) planned = exploration.plan(scene.time());
  ASSERT_TRUE(planned);
  EXPECT_TRUE(test::same(planned->trajectory.at(planned->trajectory.begin()).pose, elsewhere));
  EXPECT_TRUE(planned->step.robots[1].goal.pose) << planned->step.robots[1].goal.reason;
}

// In the cell in which it was lost, and over the floor at its start, which it has not seen.
TEST_P(JoinedRobotsBy, DriveFromTheirStart) {
  TeamInMotion scene("room", {ugv_description()}, sim::AtContact::kGoOn, GetParam());
  ContinuousExploration& exploration = scene.exploration();
  exploration.lose(0, scene.team().starts[0].pose, 0.0);
  EXPECT_EQ(exploration.end(), ExplorationEnd::kNothingToDo);
  ExplorationStart start = rests_at(scene, 0);
  start.pose.position.z() += 0.2;  // in the next layer of voxels, by its localization
  exploration.join(0, start, 0.0);
  EXPECT_TRUE(test::same(exploration.at(0, 0.0).pose, scene.team().starts[0].pose));
  EXPECT_FALSE(exploration.end());
  scene.explore(6.0);
  EXPECT_GT(scene.robots().records()[0].length, 1.0);
}

TEST(JoinedRobots, AreRefusedUnlessTheyWereLost) {
  TeamInMotion scene("room", {small_uav(), small_uav()});
  ContinuousExploration& exploration = scene.exploration();
  const ExplorationStart start = rests_at(scene, 1);
  EXPECT_THROW(exploration.join(1, start, 0.0), std::invalid_argument);
  EXPECT_THROW(exploration.join(2, start, 0.0), std::invalid_argument);
  exploration.lose(1, start.pose, 0.0);
  const ExplorationStart nowhere{{{NAN, 0, 0}, 0.0}, {}};
  EXPECT_THROW(exploration.join(1, nowhere, 0.0), std::invalid_argument);
  EXPECT_THROW(exploration.join(1, start, INFINITY), std::invalid_argument);
  exploration.join(1, start, 0.0);
  EXPECT_THROW(exploration.join(1, start, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::planner
