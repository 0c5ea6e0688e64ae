// Several robots in motion: they keep apart, and what a lost one was to see becomes the others'.

#include "planner/exploration/team_in_motion.hpp"

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

}  // namespace
}  // namespace frontlux::planner
