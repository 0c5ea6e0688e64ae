// Scans that are rare, or reach the map late: robots wait for them where they have something to see.

#include "planner/exploration/team_in_motion.hpp"

#include <deque>

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::small_uav;
using test::TeamInMotion;

class SlowScans : public testing::TestWithParam<GoalChoice> {};
INSTANTIATE_TEST_SUITE_P(Each, SlowScans, testing::ValuesIn(test::kGoalChoices), test::name_of_choice);

// On its way a robot takes scans; where it has arrived the next one lets it wait.
TEST_P(SlowScans, AreAwaitedAtTheGoal) {
  const test::TeamInWorld team("room", 1, {small_uav()});
  ContinuousExploration exploration(TeamInMotion::options(team, GetParam()), team.empty_map());
  exploration.begin(team.starts, 0.0);
  const auto scan = [&](double time) {
    const Pose pose = exploration.at(0, time).pose;
    exploration.insert(0, pose,
                       {pose.position.cast<float>(),
                        0.01,
                        {Eigen::Vector3f::UnitX()},
                        {std::numeric_limits<float>::infinity()}});  // it changes nothing
  };
  const auto first = exploration.plan(0.0);
  ASSERT_TRUE(first && first->step.robots[0].goal.pose);
  const double arrives = first->trajectory.end();
  ASSERT_GT(arrives, 1.0);
  double time = 0.1;
  for (; time < arrives + 4.0; time += 0.1) {
    if (time < arrives - 0.5) scan(time);
    while (const auto now = exploration.plan(time)) {
      EXPECT_NE(now->reason, PlanReason::kArrival) << time;
      ASSERT_LE(now->trajectory.end(), std::max(arrives + 0.2, time + 0.2)) << "it keeps its goal";
    }
  }
  bool arrived = false;
  for (const double end = time + 1.0; time < end && !arrived; time += 0.1) {
    scan(time);
    while (const auto now = exploration.plan(time)) arrived = arrived || now->reason == PlanReason::kArrival;
  }
  EXPECT_TRUE(arrived);
}

// Nothing is known before the first scan is there, and when a robot comes to rest the last ones are on their
// way.
TEST_P(SlowScans, AreNoEndBeforeTheyAreThere) {
  constexpr double kDelay = 4.0;  // [s]
  const test::TeamInWorld team("room", 1, {small_uav()});
  sim::MovingRobots robots(team.world, team.truth, team.robots, {{team.starts[0].pose}}, {}, 1,
                           sim::AtContact::kGoOn);
  ContinuousExploration exploration(TeamInMotion::options(team, GetParam()), team.empty_map());
  exploration.begin(team.starts, 0.0);
  std::deque<sim::MovingRobots::Sensed> on_their_way;
  std::vector<sim::MovingRobots::Stopped> stopped;
  while (!exploration.end() && robots.next_time() < 400.0) {
    const double time = robots.next_time();
    while (exploration.plan(time)) {
    }
    on_their_way.push_back(
        robots.advance([&](std::size_t r, double t) { return exploration.at(r, t); }, stopped));
    for (; !on_their_way.empty() && on_their_way.front().time + kDelay <= time; on_their_way.pop_front())
      exploration.insert(0, on_their_way.front().pose, on_their_way.front().scan);
  }
  EXPECT_TRUE(exploration.end());
  EXPECT_GT(test::share_mapped(team, exploration.mapping().grid()), 0.98);
}

}  // namespace
}  // namespace frontlux::planner
