// Rays that return from nowhere close what is free for a moment.

#include "planner/exploration/team_in_motion.hpp"

#include <limits>
#include <utility>

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::small_uav;
using test::TeamInMotion;
using test::TeamInWorld;

constexpr double kLong = 300.0;  // [s]
constexpr float kRange = 2.0F;   // [m]
constexpr float kNothing = std::numeric_limits<float>::infinity();

// A robot at its start, which measures along x.
struct AtStart {
  TeamInWorld team{"room", 1, {small_uav()}};
  ContinuousExploration exploration;
  const Pose pose = team.starts[0].pose;

  explicit AtStart(GoalChoice choice = GoalChoice::kTours)
      : exploration(TeamInMotion::options(team, choice), team.empty_map()) {
    exploration.begin(team.starts, 0.0);
  }
  void scan(int times, float range) {
    const Scan ray{pose.position.cast<float>(), kRange, {Eigen::Vector3f::UnitX()}, {range}};
    for (int i = 0; i < times; ++i) exploration.insert(0, pose, ray);
  }
  // A ray that ends near the end of a trajectory, or passes it.
  [[nodiscard]] Scan ray_towards(const Trajectory& trajectory, bool passes) const {
    const double time = trajectory.begin() + 0.9 * (trajectory.end() - trajectory.begin());
    const Eigen::Vector3f to = (trajectory.at(time).pose.position - pose.position).cast<float>();
    return {pose.position.cast<float>(), kRange, {to.normalized()}, {passes ? kNothing : to.norm()}};
  }
};

// Those that end in the voxel beside a robot, until rays have passed that: three for a single one, and for a
// surface six more once the map has it free.
TEST(StrayReturns, ShutARobotInForAMomentOnly) {
  for (const auto& [ended, passed] : {std::pair(1, 3), std::pair(3, 12)}) {
    SCOPED_TRACE(ended);
    AtStart robot;
    robot.scan(ended, 0.3F);
    auto planned = robot.exploration.plan(0.0);
    ASSERT_TRUE(planned);
    EXPECT_EQ(planned->step.robots[0].goal.state, GoalState::kNoCorridor);
    EXPECT_FALSE(robot.exploration.end());
    robot.scan(passed, kNothing);
    planned = robot.exploration.plan(1.0);
    ASSERT_TRUE(planned);
    EXPECT_TRUE(planned->step.robots[0].goal.pose);
  }
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

// Of two rays that end in a voxel ahead which the map has free, and goes on to have, the second one counts:
// on tours, where robots keep off.
TEST(StrayReturns, AreSurfacesIfThereAreTwo) {
  for (const GoalChoice choice : {GoalChoice::kTours, GoalChoice::kGoals}) {
    AtStart robot(choice);
    const auto planned = robot.exploration.plan(0.0);
    ASSERT_TRUE(planned && planned->step.robots[0].goal.pose);
    for (int i = 0; i < 10; ++i)
      robot.exploration.insert(0, robot.pose, robot.ray_towards(planned->trajectory, true));
    const Scan ray = robot.ray_towards(planned->trajectory, false);
    robot.exploration.insert(0, robot.pose, ray);
    EXPECT_FALSE(robot.exploration.plan(0.2));
    EXPECT_TRUE(robot.exploration.insert(0, robot.pose, ray).keys.empty());
    const auto again = robot.exploration.plan(0.3);
    ASSERT_EQ(again.has_value(), choice == GoalChoice::kTours);
    if (!again) continue;
    EXPECT_EQ(again->reason, PlanReason::kBlocked);
    const Lattice& lattice = robot.exploration.mapping().grid().lattice();
    const VoxelKey hit = lattice.key(Eigen::Vector3f(ray.origin + ray.directions[0] * ray.ranges[0])).value();
    const Trajectory& now = again->trajectory;
    for (double time = now.begin(); time <= now.end(); time += 0.01)
      EXPECT_NE(lattice.key(now.at(time).pose.position), hit);
  }
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
