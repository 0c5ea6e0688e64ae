// Robots in motion that could not go on: they plan anew, around what stopped them, or they are cut off.

#include "planner/exploration/team_in_motion.hpp"

#include <frontlux/planner/body_stencil.hpp>

namespace frontlux::planner {
namespace {

using test::GoalChoice;
using test::small_uav;
using test::TeamInMotion;

constexpr double kSample = 0.01;  // [s]

// A team that has explored the room for a while and planned all that there is to plan, and what its first
// robot does a moment later.
struct UnderWay {
  TeamInMotion scene;
  ContinuousExploration& exploration = scene.exploration();
  double time = begin();  // [s]
  Lattice lattice = scene.grid().lattice();
  Pose rests = exploration.at(0, time).pose;

  double begin() {
    scene.explore(2.0);
    while (exploration.plan(scene.time())) {
    }
    return scene.time() + 0.05;
  }
};

TEST(StoppedRobots, PlansAnewForARobotThatCouldNotGoOn) {
  UnderWay team{TeamInMotion("room", {small_uav(), small_uav()})};
  auto& [scene, exploration, time, lattice, rests] = team;
  // It met something that no sensor sees, where it was going.
  const Eigen::Vector3d next = exploration.at(0, time + 0.5).pose.position;
  const VoxelKey cell = lattice.key(next).value();
  ASSERT_NE(cell, lattice.key(rests.position).value()) << "the robot moves";
  exploration.stopped(0, rests, time, {&cell, 1});
  EXPECT_TRUE(test::same(exploration.at(0, time + 1.0).pose, rests));
  EXPECT_TRUE(exploration.at(0, time + 1.0).velocity.isZero());
  const auto planned = exploration.plan(time);
  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->robot, 0U);
  EXPECT_EQ(planned->reason, PlanReason::kStopped);
  EXPECT_EQ(planned->step.robots[0].blocked, std::vector<VoxelKey>{cell});
  EXPECT_TRUE(planned->step.robots[1].blocked.empty());
  const Trajectory& trajectory = planned->trajectory;
  EXPECT_TRUE(test::same(trajectory.at(trajectory.begin()).pose, rests));
  EXPECT_GT(trajectory.length(), 0.1);
  for (double t = trajectory.begin(); t < trajectory.end(); t += kSample)
    EXPECT_NE(lattice.key(trajectory.at(t).pose.position), cell);
  // Only once.
  for (int i = 0; i < 2; ++i) {
    const auto again = exploration.plan(time);
    EXPECT_TRUE(!again || again->robot != 0);
  }
}

// A robot that touches something before it has left its cell must not go there again, or it would for ever.
// Also where its body, between the middles of cells, is in voxels that are none of those around its cell.
TEST(StoppedRobots, PlansAnewIfSomethingTurnsUpWhereItsBodyWillBe) {
  int turned_up = 0;
  TeamInMotion scene("room", {small_uav()}, sim::AtContact::kGoOn, GoalChoice::kTours);
  ContinuousExploration& exploration = scene.exploration();
  std::optional<Trajectory> last;
  for (double time = 2.0; time < 14.0; time += 0.4) {
    scene.explore(time, [&](const PlannedMotion& now) { last = now.trajectory; });
    if (exploration.end()) break;
    if (last->begin() > scene.time() - 1e-6)
      continue;  // it has planned just now, and does not plan again before that
    const TravelOptions& travel = exploration.options().team[0].robot.travel;
    const VoxelGrid grid = scene.grid();
    const BodyStencil stencil(travel, grid.lattice().resolution());
    std::set<VoxelKey> around_cells;
    std::map<VoxelKey, Eigen::Vector3d> from;
    for (double t = scene.time() + 0.3; t < last->end(); t += kSample) {
      const Eigen::Vector3d position = last->at(t).pose.position;
      for_each_key(stencil.box_around(*grid.lattice().key(position)),
                   [&](const VoxelKey& key) { around_cells.insert(key); });
      for_each_key(test::voxels_at(travel, grid.lattice(), position), [&](const VoxelKey& key) {
        if (grid.at(key) == Occupancy::kFree) from.emplace(key, position);
      });
    }
    const auto found =
        std::ranges::find_if(from, [&](const auto& entry) { return !around_cells.contains(entry.first); });
    if (found == from.end()) continue;
    const auto& [voxel, position] = *found;
    const Eigen::Vector3d way = grid.lattice().exact_center(voxel) - position;
    const Scan scan{
        position.cast<float>(), 10.0, {way.normalized().cast<float>()}, {static_cast<float>(way.norm())}};
    for (int hit = 0; hit < 10; ++hit) exploration.insert(0, exploration.at(0, scene.time()).pose, scan);
    ASSERT_EQ(scene.grid().at(voxel), Occupancy::kOccupied);
    const auto planned = exploration.plan(scene.time());
    ASSERT_TRUE(planned) << time;
    EXPECT_EQ(planned->reason, PlanReason::kBlocked) << time;
    last = planned->trajectory;
    ++turned_up;
  }
  EXPECT_GT(turned_up, 15);
}

// The floor ahead of a robot that drives is seen to be missing.
TEST(StoppedRobots, PlansAnewIfAHoleTurnsUpAhead) {
  TeamInMotion scene("room", {ugv_description()}, sim::AtContact::kGoOn, GoalChoice::kTours);
  ContinuousExploration& exploration = scene.exploration();
  const Robot& robot = exploration.options().team[0].robot;
  std::optional<Trajectory> last;
  int holes = 0;
  for (double time = 1.0; time < 20.0; time += 0.1) {
    scene.explore(time, [&](const PlannedMotion& now) { last = now.trajectory; });
    if (exploration.end()) break;
    const double now = scene.time();
    if (now - last->begin() < 0.05 || last->end() - now < 1.5) continue;
    // Beams pass through the floor under where it will be in a second.
    const VoxelGrid grid = scene.grid();
    const Eigen::Vector3d ahead = last->at(now + 1.0).pose.position;
    Scan scan{ahead.cast<float>(), 10.0, {}, {}};
    const double floor = ahead.z() - robot.travel.sensor_height - grid.resolution() / 2;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y) {
        const Eigen::Vector3d hole = {ahead.x() + x * grid.resolution(), ahead.y() + y * grid.resolution(),
                                      floor};
        if (grid.at(grid.lattice().key(hole).value()) != Occupancy::kOccupied) continue;
        scan.directions.push_back((hole - ahead).normalized().cast<float>());
        scan.ranges.push_back(static_cast<float>(1.5 * (hole - ahead).norm()));
      }
    if (scan.ranges.size() < 9) continue;
    ContinuousExploration& planner = exploration;
    while (planner.plan(now)) {
    }
    for (int i = 0; i < 20; ++i) planner.insert(0, planner.at(0, now).pose, scan);
    const auto planned = planner.plan(now + 1e-3);
    ASSERT_TRUE(planned) << now;
    EXPECT_EQ(planned->reason, PlanReason::kBlocked) << now;
    ++holes;
    break;
  }
  EXPECT_EQ(holes, 1);
}

// What turns up where a robot has been is not in its way.
TEST(StoppedRobots, GoesOnIfSomethingTurnsUpBehindIt) {
  int turned_up = 0;
  for (double time = 2.0; time < 14.0; time += 0.8) {
    TeamInMotion scene("room", {small_uav()}, sim::AtContact::kGoOn, GoalChoice::kTours);
    std::optional<Trajectory> last;
    scene.explore(time, [&](const PlannedMotion& now) { last = now.trajectory; });
    ContinuousExploration& exploration = scene.exploration();
    if (exploration.end()) break;
    const Pose begin = last->at(last->begin()).pose;
    const VoxelKey voxel = scene.grid().lattice().key(begin.position).value();
    double now = std::max(scene.time(), last->begin());
    const auto is_past = [&] { return (exploration.at(0, now).pose.position - begin.position).norm() > 1.2; };
    while (now < last->end() - 0.5 && !is_past()) now += 0.05;
    if (!is_past()) continue;
    const Eigen::Vector3d from = begin.position + Eigen::Vector3d(0.0, 0.0, 1.0);
    const Scan scan{from.cast<float>(), 10.0, {-Eigen::Vector3f::UnitZ()}, {1.0F}};
    for (int hit = 0; hit < 10; ++hit) exploration.insert(0, exploration.at(0, now).pose, scan);
    ASSERT_EQ(scene.grid().at(voxel), Occupancy::kOccupied);
    const auto planned = exploration.plan(now);
    EXPECT_TRUE(!planned || planned->reason != PlanReason::kBlocked) << time;
    ++turned_up;
  }
  EXPECT_GT(turned_up, 3);
}

TEST(StoppedRobots, LeavesACellInWhichItWasStopped) {
  UnderWay team{TeamInMotion("room", {small_uav()})};
  auto& [scene, exploration, time, lattice, rests] = team;
  const VoxelKey cell = lattice.key(rests.position).value();
  exploration.stopped(0, rests, time, {});
  const auto planned = exploration.plan(time);
  ASSERT_TRUE(planned);
  EXPECT_EQ(planned->step.robots[0].blocked, std::vector<VoxelKey>{cell});
  EXPECT_EQ(planned->step.robots[0].goal.state, GoalState::kNoCorridor);
  EXPECT_GT(planned->trajectory.length(), 0.0) << "it goes back the way it came";
  const auto again = exploration.plan(planned->trajectory.end());
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->step.robots[0].goal.pose);
  EXPECT_GT(again->trajectory.length(), 0.1);
  for (double t = again->trajectory.begin(); t < again->trajectory.end(); t += kSample)
    EXPECT_NE(lattice.key(again->trajectory.at(t).pose.position), cell);
}

// Its localization says that it stands somewhat lower, in the layer below that of its sensor.
TEST(StoppedRobots, StayOnTheirPlane) {
  UnderWay team{TeamInMotion("room", {ugv_description()}, sim::AtContact::kGoOn, GoalChoice::kTours)};
  auto& [scene, exploration, time, lattice, here] = team;
  Pose lower = here;
  lower.position.z() -= 0.3;
  exploration.stopped(0, lower, time, {});
  EXPECT_EQ(exploration.at(0, time).pose.position, here.position);
  const auto planned = exploration.plan(time);
  ASSERT_TRUE(planned);
  EXPECT_GT(planned->trajectory.length(), 0.0) << "it goes back the way it came";
  EXPECT_FALSE(exploration.end());
}

// What it is stopped from is beside its way: it touches something within its cell.
TEST(StoppedRobots, LeavesACellInWhichItIsStoppedAgain) {
  UnderWay team{TeamInMotion("room", {small_uav()})};
  auto& [scene, exploration, time, lattice, rests] = team;
  const VoxelKey here = lattice.key(rests.position).value();
  const VoxelKey cell = lattice.key(exploration.at(0, time + 0.5).pose.position).value();
  ASSERT_NE(cell, here);
  exploration.stopped(0, rests, time, {&cell, 1});
  const auto first = exploration.plan(time);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->step.robots[0].goal.pose);
  const double later = first->trajectory.begin();
  exploration.stopped(0, rests, later, {&cell, 1});
  const auto second = exploration.plan(later);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->step.robots[0].blocked, (std::vector{std::min(cell, here), std::max(cell, here)}));
  EXPECT_EQ(second->step.robots[0].goal.state, GoalState::kNoCorridor);
  EXPECT_GT(second->trajectory.length(), 0.0) << "it goes back the way it came";
}

// Also where it has driven around a corner and its scans were lost, and if its stop is told late.
TEST(StoppedRobots, GoBackAsTheyCame) {
  double length = 0.0;
  for (const double beyond : {0.0, 1.0}) {  // [m] where its trajectory ends by the time
    int corners = 0;
    for (const double begin : {5.0, 18.0, 33.0}) {  // [s]
      TeamInMotion scene("maze", {small_uav()}, sim::AtContact::kGoOn, GoalChoice::kTours);
      scene.explore(begin);
      ContinuousExploration& exploration = scene.exploration();
      double time = scene.time();
      std::vector<Eigen::Vector3d> been;
      for (const double stops = time + 12.0; time < stops; time += kSample) {
        while (exploration.plan(time)) {
        }
        been.push_back(exploration.at(0, time).pose.position);
      }
      const Eigen::Vector3d end = been.back(), straight = (end - been.front()).normalized();
      const auto is_aside = [&](const Eigen::Vector3d& place) {
        const Eigen::Vector3d along = place - been.front();
        return (along - along.dot(straight) * straight).norm() > 0.5;
      };
      if (std::ranges::none_of(been, is_aside)) continue;  // it went straight on
      ++corners;
      while ((been.back() - end).norm() < beyond) been.pop_back();
      exploration.stopped(0, {been.back(), 0.0}, time, {});
      const auto planned = exploration.plan(time);
      ASSERT_TRUE(planned);
      const Trajectory& back = planned->trajectory;
      for (double t = back.begin(); t < back.end(); t += kSample) {
        const Eigen::Vector3d now = back.at(t).pose.position;
        const auto off = [&](const Eigen::Vector3d& place) { return (place - now).norm(); };
        EXPECT_LT(off(*std::ranges::min_element(been, {}, off)), 0.08) << begin << " " << beyond;
      }
      length += back.length();
    }
    EXPECT_GE(corners, 2);
  }
  EXPECT_GT(length, 1.0);
}

// Whatever they try, they are stopped where they are.
TEST(StoppedRobots, EndsWithRobotsThatAreCutOff) {
  for (const std::size_t robots : {1U, 2U}) {
    UnderWay team{TeamInMotion("room", std::vector(robots, small_uav()))};
    auto& [scene, exploration, time, lattice, first_rests] = team;
    std::vector<Pose> rests;
    for (std::size_t r = 0; r < robots; ++r) rests.push_back(exploration.at(r, time).pose);
    ASSERT_NE(rests[0].position, scene.team().starts[0].pose.position) << "it has come from elsewhere";
    for (int i = 0; i < 200 && !exploration.end(); ++i, time += 0.5) {
      for (std::size_t r = 0; r < robots; ++r) exploration.stopped(r, rests[r], time, {});
      while (exploration.plan(time)) {
      }
    }
    EXPECT_EQ(exploration.end(), ExplorationEnd::kCutOff) << robots;
  }
}

}  // namespace
}  // namespace frontlux::planner
