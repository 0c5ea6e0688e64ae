// Robots in motion give up frontiers that their planning takes for visible and their sensors do not show.

#include "planner/exploration/team_in_motion.hpp"

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::small_uav;
using test::TeamInMotion;
using test::TeamInWorld;

constexpr double kLong = 300.0;  // [s]

double turn(double from, double to) { return std::remainder(to - from, 2 * std::numbers::pi); }

// A scan of one ray.
Scan scan_with(const Pose& pose, float range, double max_range) {
  return {pose.position.cast<float>(), max_range, {Eigen::Vector3f::UnitX()}, {range}};
}
// It changes nothing.
Scan empty_scan(const Pose& pose) { return scan_with(pose, std::numeric_limits<float>::infinity(), 0.01); }

class GivenUpFrontiersBy : public testing::TestWithParam<GoalChoice> {};
INSTANTIATE_TEST_SUITE_P(Each, GivenUpFrontiersBy, testing::ValuesIn(test::kGoalChoices),
                         test::name_of_choice);

// Planning takes for visible what the camera, which looks the other way, does not see. Also if the robot
// comes to rest beside the middle of the voxel, and so in another one, where its trajectory ends.
TEST_P(GivenUpFrontiersBy, AreThoseThatItDoesNotSeeFromItsGoal) {
  for (const auto& [off, period] : {std::pair{0.0, 1.0}, {0.2, 1.0}, {0.2, 0.5}}) {
    const TeamInWorld team("room", 1, {small_uav()});
    ExplorationOptions options = TeamInMotion::options(team, GetParam());
    options.period = period;
    ContinuousExploration exploration(options, team.empty_map());
    exploration.begin(team.starts, 0.0);
    std::set<VoxelKey> given_up;
    std::size_t goals = 0, abandoned = 0;
    for (double time = 0.0; time < kLong && !exploration.end(); time += 0.1) {
      Pose pose = exploration.at(0, time).pose;
      pose.position.x() += off;
      pose.yaw = turn(std::numbers::pi, pose.yaw);
      exploration.insert(0, pose, empty_scan(pose));
      while (const auto now = exploration.plan(time)) {
        const RobotStep& robot = now->step.robots[0];
        goals += robot.goal.pose ? 1 : 0;
        given_up.insert(robot.still_unknown.begin(), robot.still_unknown.end());
        abandoned = now->step.abandoned;
      }
    }
    SCOPED_TRACE(std::to_string(off) + " m, " + std::to_string(period) + " s");
    EXPECT_EQ(exploration.end(),
              GetParam() == GoalChoice::kGoals ? ExplorationEnd::kLowGain : ExplorationEnd::kNothingToDo);
    EXPECT_GT(goals, 20U);
    EXPECT_GT(abandoned, 80U);
    EXPECT_LE(abandoned, given_up.size());
  }
}

// In a hall that it knows something is beside the robot whenever it has come some way, and gone once it has
// turned back.
TEST(GivenUpFrontiers, AreThoseOnTheWayToWhichTheMapClosesAgainAndAgain) {
  TeamInWorld team("room", 1, {small_uav()});
  const VoxelKey home = team.truth.lattice().key(team.starts[0].pose.position).value();
  team.starts[0].known_free.clear();
  for_each_key(intersection(grown({home, home}, 9, 9, 3), team.truth.bounds()).value(),
               [&](const VoxelKey& key) { team.starts[0].known_free.push_back(key); });
  ContinuousExploration exploration(TeamInMotion::options(team, GoalChoice::kTours), team.empty_map());
  exploration.begin(team.starts, 0.0);
  std::optional<Eigen::Vector3d> closed;
  Eigen::Vector3d from = team.starts[0].pose.position;
  const auto scan_towards = [&](const Pose& pose, const Eigen::Vector3d& direction, float range, int times) {
    Scan ray = scan_with(pose, range, 2.0);
    ray.directions[0] = direction.normalized().cast<float>();
    for (int i = 0; i < times; ++i) exploration.insert(0, pose, ray);
  };
  std::size_t turns = 0, abandoned = 0;
  for (double time = 0.0; time < kLong && !exploration.end(); time += 0.1) {
    const auto [pose, velocity, yaw_rate] = exploration.at(0, time);
    if (!closed && (pose.position - from).norm() > 0.25 && velocity.norm() > 0.1) {
      const double latency = exploration.options().latency;
      closed = exploration.at(0, time + latency).pose.position + Eigen::Vector3d(0.3, -0.3, 0.0);
      const Eigen::Vector3d offset = *closed - pose.position;
      scan_towards(pose, offset, static_cast<float>(offset.norm()), 3);
    } else if (closed && velocity.isZero()) {
      scan_towards(pose, *closed - pose.position, std::numeric_limits<float>::infinity(), 12);
      closed.reset();
      from = pose.position;
    }
    while (const auto now = exploration.plan(time)) {
      const bool was_closed = now->reason == PlanReason::kBlocked;
      turns += was_closed && now->step.robots[0].goal.state == GoalState::kNoCorridor ? 1 : 0;
      abandoned = now->step.abandoned;
    }
  }
  EXPECT_GT(turns, 20U);
  EXPECT_GT(abandoned, 200U) << "it goes back and forth";
}

// Each robot gives up what it has not seen, also if both plan at the same times.
TEST_P(GivenUpFrontiersBy, AreThoseThatEitherRobotDoesNotSee) {
  const TeamInWorld team("room", 1, {small_uav(), small_uav()});
  ContinuousExploration exploration(TeamInMotion::options(team, GetParam()), team.empty_map());
  exploration.begin(team.starts, 0.0);
  std::array<std::size_t, 2> given_up{};
  std::set<VoxelKey> all;
  std::size_t abandoned = 0;
  for (double time = 0.0; time < 30.0 && !exploration.end(); time += 1.0) {
    for (std::size_t r = 0; r < 2; ++r) {
      const Pose pose = exploration.at(r, time).pose;
      exploration.insert(r, pose, empty_scan(pose));
    }
    while (const auto now = exploration.plan(time)) {
      const std::vector<VoxelKey>& keys = now->step.robots[now->robot].still_unknown;
      given_up.at(now->robot) += keys.size();
      all.insert(keys.begin(), keys.end());
      EXPECT_GE(now->step.abandoned, abandoned) << "nothing is mapped";
      abandoned = now->step.abandoned;
    }
  }
  EXPECT_GT(given_up[0], 0U);
  EXPECT_GT(given_up[1], 0U);
  EXPECT_GT(abandoned, 0U);
  EXPECT_LE(abandoned, all.size());
}

// A sensor that has failed for a while shows nothing of what is in its view.
TEST_P(GivenUpFrontiersBy, AreNoneForScansWithoutRanges) {
  const TeamInWorld team("room", 1, {small_uav()});
  const auto given_up = [&](float range, double max_range) {
    ContinuousExploration exploration(TeamInMotion::options(team, GetParam()), team.empty_map());
    exploration.begin(team.starts, 0.0);
    std::size_t keys = 0, plannings = 0, looks = 0;
    std::optional<Pose> goal;
    for (double time = 0.0; time < 20.0; time += 0.1) {
      const Pose pose = exploration.at(0, time).pose;
      exploration.insert(0, pose, scan_with(pose, range, max_range));
      looks +=
          goal && (pose.position - goal->position).norm() < 0.01 && std::abs(turn(goal->yaw, pose.yaw)) < 0.01
              ? 1
              : 0;
      while (const auto now = exploration.plan(time)) {
        goal = now->step.robots[0].goal.pose;
        keys += now->step.robots[0].still_unknown.size();
        ++plannings;
      }
    }
    EXPECT_GT(plannings, 10U);
    EXPECT_GT(looks, 3U) << "it has been at its goals";
    return keys;
  };
  EXPECT_EQ(given_up(std::numeric_limits<float>::quiet_NaN(), 10.0), 0U);
  EXPECT_GT(given_up(std::numeric_limits<float>::infinity(), 0.01), 0U) << "a sensor that sees nothing";
}

// What hides some of the view from the sensor, as another robot, is in no map: there it measures nothing.
TEST_P(GivenUpFrontiersBy, AreInDirectionsInWhichItMeasures) {
  constexpr double kFound = 0.06;  // [rad] of a ray, and a little more
  const TeamInWorld team("room", 1, {small_uav()});
  ContinuousExploration exploration(TeamInMotion::options(team, GetParam()), team.empty_map());
  exploration.begin(team.starts, 0.0);
  const auto left_of = [](const Pose& pose, const Eigen::Vector3d& offset) {
    return offset.y() * std::cos(pose.yaw) - offset.x() * std::sin(pose.yaw);
  };
  std::size_t given_up = 0;
  for (double time = 0.0; time < 60.0 && !exploration.end(); time += 0.1) {
    const Pose pose = exploration.at(0, time).pose;
    Scan scan{pose.position.cast<float>(), 0.01, {}, {}};
    for (double azimuth = -3.14; azimuth < 3.15; azimuth += 0.04)
      for (double elevation = -1.2; elevation < 1.2; elevation += 0.04) {
        const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation),
                                        std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
        scan.directions.push_back(direction.normalized().cast<float>());
        scan.ranges.push_back(left_of(pose, direction) > 0.0 ? std::numeric_limits<float>::quiet_NaN()
                                                             : std::numeric_limits<float>::infinity());
      }
    exploration.insert(0, pose, scan);
    while (const auto now = exploration.plan(time)) {
      if (now->reason == PlanReason::kArrival) continue;  // it gives up what it came for
      for (const VoxelKey& key : now->step.robots[0].still_unknown) {
        const Eigen::Vector3d offset = team.empty_map().grid().lattice().exact_center(key) - pose.position;
        EXPECT_LE(left_of(pose, offset) / offset.norm(), kFound);
        ++given_up;
      }
    }
  }
  EXPECT_GT(given_up, 20U);
}

TEST_P(GivenUpFrontiersBy, AreAtLastThoseOfASensorThatShowsNothing) {
  const TeamInWorld team("room", 1, {small_uav()});
  ExplorationOptions options = TeamInMotion::options(team, GetParam());
  options.commitment = 2.0;
  ContinuousExploration exploration(options, team.empty_map());
  exploration.begin(team.starts, 0.0);
  for (double time = 0.0; time < kLong && !exploration.end(); time += 0.1) {
    const Pose pose = exploration.at(0, time).pose;
    exploration.insert(0, pose, scan_with(pose, std::numeric_limits<float>::quiet_NaN(), 10.0));
    while (exploration.plan(time)) {
    }
  }
  EXPECT_TRUE(exploration.end());
}

// The last scan before a sensor fails may show nothing, and be from anywhere.
TEST_P(GivenUpFrontiersBy, AreNoneForAnEmptyScanFromElsewhere) {
  const TeamInWorld team("room", 1, {small_uav()});
  ExplorationOptions options = TeamInMotion::options(team, GetParam());
  options.commitment = 2.0;
  ContinuousExploration exploration(options, team.empty_map());
  exploration.begin(team.starts, 0.0);
  exploration.insert(0, team.starts[0].pose,
                     scan_with(team.starts[0].pose, std::numeric_limits<float>::quiet_NaN(), 10.0));
  std::size_t keys = 0, goals = 0;
  for (double time = 0.0; time < 60.0; time += 0.1)
    while (const auto now = exploration.plan(time)) {
      keys += now->step.robots[0].still_unknown.size();
      const auto& goal = now->step.robots[0].goal.pose;
      // Farther than the half a voxel within which a scan counts as from there.
      goals += goal && (goal->position - team.starts[0].pose.position).norm() > 0.16 ? 1 : 0;
    }
  EXPECT_GT(goals, 10U);
  EXPECT_EQ(keys, 0U);
}

}  // namespace
}  // namespace frontlux::planner
