// Rays that return from nowhere close what is free for a moment.

#include "planner/exploration/team_in_motion.hpp"

#include <limits>

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::small_uav;
using test::TeamInMotion;
using test::TeamInWorld;

constexpr double kLong = 300.0;  // [s]
constexpr float kRange = 2.0F;   // [m]

// A robot at its start, which measures along x.
struct AtStart {
  TeamInWorld team{"room", 1, {small_uav()}};
  ContinuousExploration exploration{TeamInMotion::options(team, GoalChoice::kTours), team.empty_map()};
  const Pose pose = team.starts[0].pose;

  AtStart() { exploration.begin(team.starts, 0.0); }
  void scan(int times, float range) {
    const Scan ray{pose.position.cast<float>(), kRange, {Eigen::Vector3f::UnitX()}, {range}};
    for (int i = 0; i < times; ++i) exploration.insert(0, pose, ray);
  }
};

// One that ends in the voxel beside a robot, until rays have passed that.
TEST(StrayReturns, ShutARobotInForAMomentOnly) {
  AtStart robot;
  robot.scan(3, 0.3F);
  auto planned = robot.exploration.plan(0.0);
  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->step.robots[0].goal.state, GoalState::kNoCorridor);
  EXPECT_FALSE(robot.exploration.end());
  robot.scan(9, std::numeric_limits<float>::infinity());
  planned = robot.exploration.plan(1.0);
  ASSERT_TRUE(planned);
  EXPECT_TRUE(planned->step.robots[0].goal.pose);
}

TEST(StrayReturns, AreNotWhereARobotIs) {
  AtStart robot;
  robot.scan(3, 0.01F);
  const VoxelGrid& grid = robot.exploration.mapping().grid();
  ASSERT_EQ(grid.at(grid.lattice().key(robot.pose.position).value()), Occupancy::kOccupied);
  const auto planned = robot.exploration.plan(0.0);
  ASSERT_TRUE(planned);
  EXPECT_TRUE(planned->step.robots[0].goal.pose);
}

// One planning that finds nothing to do is no end, nor are two at about the same time.
TEST(StrayReturns, EndsIfThereIsNothingToDoForAWhile) {
  TeamInMotion scene("room", {small_uav()}, sim::AtContact::kGoOn, GoalChoice::kTours);
  std::vector<double> idle;
  scene.explore(kLong, [&](const PlannedMotion& now) {
    if (now.step.robots[0].goal.pose)
      idle.clear();
    else
      idle.push_back(now.step.time);
  });
  ASSERT_EQ(scene.exploration().end(), ExplorationEnd::kNothingToDo);
  ASSERT_GE(idle.size(), 2U);
  EXPECT_GE(idle.back() - idle.front(), 1.5 * scene.exploration().options().period);
}

}  // namespace
}  // namespace frontlux::planner
