// Robots that do not know exactly where they are, or are not where they are to be.
#include "sim/robot/moving_in_a_room.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

namespace frontlux::sim {
namespace {

// How far a robot is from where it believes to be, by what its scans say of the walls and the floor.
Vector3d error_by(const planner::Scan& scan) {
  const Vector3d far(6, 6, 3);
  Vector3d error = Vector3d::Constant(std::nan(""));
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const Vector3d way = scan.directions[i].cast<double>() * static_cast<double>(scan.ranges[i]);
    const Vector3d hit = scan.origin.cast<double>() + way;
    if (!hit.allFinite()) continue;
    for (int a = 0; a < 3; ++a) {
      const double wall = way[a] > 0 ? far[a] : 0.0;
      bool first = std::abs(hit[a] - wall) < 0.4;  // of the axes, this wall is the one that was hit
      for (int b = 0; b < 3; ++b) first = first && (b == a || (hit[b] > 0.5 && hit[b] < far[b] - 0.5));
      if (first) error[a] = wall - hit[a];
    }
  }
  return error;
}

TEST(MovingRobots, DriftByAPartOfTheirWayUntilTheyKnowTheirPlace) {
  constexpr double kDrift = 0.04, kFix = 3.0;
  const BoxRoom room;
  RobotDescription lidar = planner::uav_description();
  lidar.robot.view = {FieldOfView::Shape::kSpinning, 0.0, 2.8, 10.0};
  lidar.columns = 180;
  lidar.rows = 60;
  lidar.rate = 10.0;
  const Vector3d from(2, 2, 1.2), to(2, 2.75, 1.2);
  // Back and forth, 0.5 m/s.
  const auto way = [](double time) { return 0.5 * time; };
  const auto where = [&](std::size_t, double time) {
    const double along = std::fmod(way(time), 1.5);
    return at(from + (along < 0.75 ? along : 1.5 - along) / 0.75 * (to - from));
  };
  for (const double fix : {0.0, kFix}) {
    Moving scene(room, {lidar}, {{from, 0.0}}, AtContact::kGoOn, {}, 1, {kDrift, fix});
    std::vector<Vector3d> directions;
    for (double time = 0.0; time < 8.9;) {
      const auto sensed = scene.robots.advance(where, scene.stopped);
      time = sensed.time;
      EXPECT_EQ(sensed.pose.position, where(0, time).pose.position) << "it believes to be on its way";
      EXPECT_EQ(sensed.scan.origin, sensed.pose.position.cast<float>());
      const double since = fix == 0.0 ? time : std::fmod(time, kFix);
      const Vector3d error = error_by(sensed.scan);
      if (fix > 0.0 && time >= kFix && since < 1.05) continue;  // on its way back
      EXPECT_NEAR(error.norm(), kDrift * way(since), 0.005) << time;
      if (since > 2.5) directions.push_back(error.normalized());
    }
    ASSERT_GT(directions.size(), 10U);
    for (const Vector3d& one : directions) EXPECT_TRUE(fix > 0.0 || one.dot(directions.front()) > 0.99);
    EXPECT_EQ(directions.back().dot(directions.front()) < 0.9, fix > 0.0) << "then it is drawn anew";
    // It moves by its errors, too.
    EXPECT_NEAR(scene.record().length, way(8.9), 0.5);
  }
}

// A robot learns that it is not in the wall that it believed to fly into, and a bumper keeps it from going
// there.
TEST(MovingRobots, ThatAreHeldOnTheWayBackToTheirTrajectoryGoOn) {
  constexpr double kFix = 4.0;
  const BoxRoom room;
  const Vector3d middle(3, 3, 1.5);
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Moving scene(room, {small(planner::uav_description(), 5.0)}, {{middle, 0.0}}, AtContact::kStay, {}, seed,
                 {0.3, kFix});
    std::optional<std::pair<double, Vector3d>> back;  // from when, and from where
    const auto where = [&](std::size_t, double time) {
      if (back) return at(on_the_way(back->second, middle, time - back->first));
      return at({3 - 0.675 * std::min(time, kFix), 3, 1.5});
    };
    scene.go_on(kFix, where);
    if (!scene.stopped.empty()) continue;  // it has drifted towards the wall
    std::size_t stops = 0;
    for (double time = kFix; time < 12.0; time += 0.2) {
      scene.go_on(time, where);
      if (scene.stopped.empty()) continue;
      ++stops;
      back = {scene.stopped.back().time, scene.stopped.back().pose.position};
      scene.stopped.clear();
    }
    if (stops == 0) continue;
    ++held;
    EXPECT_LE(stops, 3U) << seed;
    EXPECT_NEAR((scene.robots.believed(0).position - middle).norm(), 0.0, 1e-9) << seed;
  }
  EXPECT_GT(held, 5);
}

TEST(MovingRobots, ThatDriveStayOnTheirFloorWhateverTheirErrors) {
  const BoxRoom room;
  for (const planner::Motion motion : {planner::Motion::kPlane, planner::Motion::kGround}) {
    RobotDescription lidar = planner::ugv_description();
    lidar.robot.travel.motion = motion;
    lidar.robot.view = {FieldOfView::Shape::kSpinning, 0.0, 2.8, 10.0};
    lidar.columns = 180;
    lidar.rows = 60;
    const Vector3d from(2, 2, lidar.robot.travel.sensor_height);
    const auto where = [&](std::size_t, double time) { return at(from + Vector3d(0, 0.5 * time, 0)); };
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Moving scene(room, {lidar}, {{from, 0.0}}, AtContact::kGoOn, {}, seed, {0.2, 0.0});
      Vector3d error = Vector3d::Zero();
      for (double time = 0.0; time < 2.0;) {
        const auto sensed = scene.robots.advance(where, scene.stopped);
        time = sensed.time;
        error = error_by(sensed.scan);
      }
      EXPECT_GT(error.head<2>().norm(), 0.15);
      EXPECT_NEAR(error.z(), 0.0, 1e-5);
    }
  }
}

// At most so far at its greatest speed, in proportion when slower; its scans are right, since it knows.
TEST(MovingRobots, SwayAroundTheirTrajectoryAndKnow) {
  constexpr double kTracking = 0.2;
  const BoxRoom room;
  const Surface surface(room.world.mesh);
  for (const RobotDescription& robot : {uav(50.0), ugv(50.0)}) {
    const bool drives = robot.robot.travel.drives();
    for (const double speed : {robot.robot.limits.speed, robot.robot.limits.speed / 4, 0.0}) {
      const Vector3d from(3, 3, drives ? robot.robot.travel.sensor_height : 1.2);
      const auto where = [&](std::size_t, double time) {
        MotionState state = at(from + Vector3d(std::sin(time), std::cos(time), 0));
        state.velocity = {speed, 0.0, 0.0};
        return state;
      };
      double most = 0.0;
      for (const std::uint64_t seed : {1, 2, 3}) {
        Moving scene(room, {robot}, {{where(0, 0).pose}}, AtContact::kGoOn, {}, seed,
                     {.tracking = kTracking});
        for (double time = 0.0; time < 20.0;) {
          const auto sensed = scene.robots.advance(where, scene.stopped);
          time = sensed.time;
          const Vector3d off = sensed.pose.position - where(0, time).pose.position;
          EXPECT_LE(off.norm(), kTracking * speed / robot.robot.limits.speed + 1e-12);
          EXPECT_TRUE(!drives || off.z() == 0.0);
          most = std::max(most, off.norm());
          EXPECT_EQ(sensed.scan.origin, sensed.pose.position.cast<float>());
          const planner::Scan alone = sense(surface, sensor_of(robot, {}), sensed.pose, 0);
          EXPECT_TRUE(same_bits(sensed.scan, alone)) << "it is where it believes";
          if (time > 2.0 && seed != 1) break;
        }
      }
      EXPECT_GE(most, 0.8 * kTracking * speed / robot.robot.limits.speed);
    }
  }
}

TEST(MovingRobots, RefusePoseErrorsThatAreNone) {
  const BoxRoom room;
  for (const PoseErrors& wrong :
       {PoseErrors{-0.1, 0.0}, PoseErrors{1.1, 0.0}, PoseErrors{std::nan(""), 0.0}, PoseErrors{0.1, -1.0},
        PoseErrors{0.1, std::nan("")}, PoseErrors{.tracking = -0.1}, PoseErrors{.tracking = 10.1},
        PoseErrors{.tracking = std::nan("")}})
    EXPECT_REFUSED(Moving(room, {uav()}, {{{1, 1, 1}, 0.0}}, AtContact::kGoOn, {}, 1, wrong));
}

}  // namespace
}  // namespace frontlux::sim
