#include "sim/robot/moving_in_a_room.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

namespace frontlux::sim {
namespace {

TEST(MovingRobots, ScanAtTheirOwnRatesInOrderOfTimeAndRobot) {
  const BoxRoom room;
  const std::vector<double> rates = {10.0, 15.0, 4.0, 10.0};
  std::vector<RobotDescription> team;
  std::vector<Pose> starts;
  for (const double rate : rates) {
    team.push_back(uav(rate));
    starts.push_back({{1.0 + 1.2 * static_cast<double>(starts.size()), 1.0, 1.5}});
  }
  Moving scene(room, team, starts);
  const auto where = [&](std::size_t robot, double time) {
    return at(starts[robot].position + Vector3d(0.0, time, 0.0), 0.3 * time);
  };
  std::vector<std::pair<double, std::size_t>> expected;
  for (std::size_t r = 0; r < rates.size(); ++r)
    for (int i = 0; i / rates[r] <= 2.0; ++i) expected.emplace_back(i / rates[r], r);
  std::sort(expected.begin(), expected.end());
  const Surface surface(room.world.mesh);
  for (const auto& [time, robot] : expected) {
    EXPECT_DOUBLE_EQ(scene.robots.next_time(), time);
    const MovingRobots::Sensed sensed = scene.robots.advance(where, scene.stopped);
    EXPECT_DOUBLE_EQ(sensed.time, time);
    ASSERT_EQ(sensed.robot, robot);
    // From where the robot is at that moment.
    const Pose pose = where(robot, time).pose;
    EXPECT_LT((sensed.pose.position - pose.position).norm(), 1e-12);
    EXPECT_NEAR(sensed.pose.yaw, pose.yaw, 1e-12);
    EXPECT_TRUE(same_bits(sensed.scan, sense(surface, sensor_of(team[robot]), sensed.pose, 1)));
  }
  EXPECT_TRUE(scene.stopped.empty());
}

TEST(MovingRobots, ErrorsAreOfTheSeedTheRobotAndTheScan) {
  const BoxRoom room;
  const std::vector<Pose> starts = {{{1.5, 1.5, 1.5}}, {{1.5, 1.5, 1.5}}};
  const auto scans = [&](std::uint64_t seed) {
    Moving scene(room, {uav(), uav()}, starts, AtContact::kGoOn, {.sigma = 0.1}, seed);
    std::vector<planner::Scan> list;
    while (list.size() < 4)
      list.push_back(
          scene.robots.advance([&](auto...) { return MotionState{starts[0]}; }, scene.stopped).scan);
    return list;
  };
  const auto one = scans(1), again = scans(1), other = scans(2);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(same_bits(one[i], again[i]));
    EXPECT_FALSE(same_bits(one[i], other[i]));
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(same_bits(one[i], one[k])) << i << ", " << k;
  }
}

TEST(MovingRobots, CountMetresAndIdleSeconds) {
  const BoxRoom room;
  const Vector3d from(1, 1, 1.5), corner(1, 2.5, 1.5), to(2, 2.5, 1.5);
  Moving scene(room, {uav(), uav()}, {{from}, {{4, 4, 1.5}}});
  // 1.5 m and 1 m, 0.7 s of rest, 0.8 s of turning, 1 s of rest; the other one always turns.
  const auto where = [&](std::size_t robot, double time) {
    if (robot == 1) return at({4, 4, 1.5}, 0.1 * time);
    const Vector3d position =
        time < 1.5 ? on_the_way(from, corner, time) : on_the_way(corner, to, time - 1.5);
    return at(position, std::clamp(time - 3.2, 0.0, 0.8));
  };
  scene.go_on(5.0, where);
  EXPECT_NEAR(scene.record(0).length, 2.5, 1e-9);
  EXPECT_NEAR(scene.record(0).idle, 1.7, 0.021);
  EXPECT_EQ(scene.record(1).length, 0.0);
  EXPECT_EQ(scene.record(1).idle, 0.0);
  EXPECT_EQ(scene.record(0).contacts.size() + scene.record(0).held_back, 0U);
}

// 4 m there, back and there again, at 1 m/s: from 6.5 s on it is within 1 m of where it was 6 m before.
TEST(MovingRobots, TellWhichPartOfTheirPathTheyHadBeenOn) {
  const BoxRoom room;
  const Vector3d from(1, 2, 1.5), to(5, 2, 1.5);
  Moving scene(room, {uav()}, {{from}});
  scene.go_on(12.0, [&](std::size_t, double time) {
    return at(time < 4.0   ? on_the_way(from, to, time)
              : time < 8.0 ? on_the_way(to, from, time - 4.0)
                           : on_the_way(from, to, time - 8.0));
  });
  EXPECT_NEAR(scene.record().length, 12.0, 0.1);
  EXPECT_NEAR(scene.record().revisited, 5.5 / 12.0, 0.005);
}

// Half a body is 0.4 m: it touches the pane from 2.6 m to 3.4 m.
TEST(MovingRobots, CountEachTouchOnce) {
  BoxRoom room;
  room.add_pane(3.0F);
  Moving scene(room, {uav()}, {{{1.5, 4, 1.5}}});
  double begin = 0.0;
  Vector3d from(1.5, 4, 1.5);
  const auto go = [&](const Vector3d& to) {
    scene.go_on(begin + 3.0,
                [&](std::size_t, double time) { return at(on_the_way(from, to, time - begin)); });
    begin += 3.0;
    from = to;
    return scene.record().contacts.size();
  };
  EXPECT_EQ(go({2.59, 4, 1.5}), 0U);
  EXPECT_EQ(go({3.0, 4, 1.5}), 1U);    // into it, and it rests there
  EXPECT_EQ(go({3.0, 4.5, 1.5}), 1U);  // along it: still the same touch
  EXPECT_EQ(go({4.5, 4.5, 1.5}), 1U);  // out on the other side
  EXPECT_EQ(go({2.0, 4.5, 1.5}), 2U);  // back, right through
  EXPECT_EQ(go({2.0, 1.0, 1.5}), 2U);
  EXPECT_EQ(go({4.5, 1.0, 1.5}), 2U);  // beside it
  EXPECT_EQ(go({4.5, 0.3, 1.5}), 3U);  // another surface
  EXPECT_EQ(scene.record().held_back, 0U);
  EXPECT_TRUE(scene.stopped.empty());
  EXPECT_LT(scene.record().clearance, 1e-3);
  // The first one was a body that reached the pane, on its way at 0.5 m/s at most from 3 s on.
  const Contact& first = scene.record().contacts.front();
  EXPECT_GT(first.time, 3.0);
  EXPECT_LT(first.time, 3.1);
  EXPECT_GE(first.body.max().x(), 3.0);
  EXPECT_LT(first.body.max().x(), 3.0 + 0.1);
  EXPECT_NEAR(first.body.min().x(), first.body.max().x() - 0.8, 0.03) << "and a step of the motion";
}

// Past the upright edge of a pane, half a metre from it: a corner of the box around them meets it.
TEST(MovingRobots, RoundBodiesTouchWithTheirTrueShape) {
  BoxRoom room;
  room.add_pane(3.0F);
  const double off = 0.5 / std::numbers::sqrt2;
  const Vector3d middle(3 + off, 2 - off, 1.5), from = middle - Vector3d(1, 1, 0),
                                                to = middle + Vector3d(1.5, 1.5, 0);
  for (const bool flies : {true, false})
    for (const planner::BodyShape shape :
         {planner::BodyShape::kBox, planner::BodyShape::kCylinder, planner::BodyShape::kSphere}) {
      RobotDescription robot = flies ? uav() : ugv();
      robot.robot.travel.shape = shape;
      robot.robot.travel.extents = {0.8, 0.8, 0.8};
      Moving scene(room, {robot}, {{from}});
      scene.go_on(4.0, [&](std::size_t, double time) { return at(on_the_way(from, to, time)); });
      const bool box = shape == planner::BodyShape::kBox;
      EXPECT_EQ(scene.record().contacts.size(), box ? 1U : 0U);
      EXPECT_NEAR(scene.record().clearance, box ? 0.0 : 0.1, 4e-4);
    }
}

TEST(MovingRobots, StayWhereABumperStopsThem) {
  BoxRoom room;
  room.add_pane(3.0F);
  const Vector3d from(1.5, 4, 1.5), to(4.5, 4, 1.5), other(1, 1, 1.5);
  Moving scene(room, {uav(2.0), uav(2.0)}, {{from}, {other}}, AtContact::kStay);
  const auto where = [&](std::size_t robot, double time) {
    return robot == 1 ? at(on_the_way(other, {5, 1, 1.5}, time)) : at(on_the_way(from, to, time), 0.1);
  };
  scene.go_on(1.0, where);
  EXPECT_TRUE(scene.stopped.empty());
  scene.go_on(1.5, where);
  ASSERT_EQ(scene.stopped.size(), 1U);
  const auto [robot, since, pose, blocked] = scene.stopped[0];
  EXPECT_EQ(robot, 0U);
  // From the moment on at which it was there, long before the call's end.
  EXPECT_NEAR(since, pose.position.x() - 1.5, 1e-9);
  // It is as near as a step of a fiftieth of a second allows.
  EXPECT_LE(pose.position.x(), 2.6 + GroundTruth::kMargin);
  EXPECT_GE(pose.position.x(), 2.6 - 0.021);
  EXPECT_EQ(pose.yaw, 0.1);
  // It was about to enter the voxel in front of it, whose key is one more along x.
  const Lattice& lattice = scene.truth.lattice();
  const VoxelKey own = lattice.key(pose.position).value();
  EXPECT_TRUE(std::is_sorted(blocked.begin(), blocked.end()));
  EXPECT_TRUE(std::ranges::count(blocked, make_key(own.x + 1, own.y, own.z)) == 1);
  for (const VoxelKey& key : blocked)
    EXPECT_TRUE(key != own && key.y == own.y && key.z == own.z && key.x <= own.x + 2);
  EXPECT_EQ(scene.record(0).held_back, 1U);
  EXPECT_EQ(scene.record(0).contacts.size(), 0U);
  EXPECT_NEAR(scene.record(0).length, pose.position.x() - 1.5, 1e-9);
  // It is at rest from then until the call's end, while the other one goes on.
  EXPECT_NEAR(scene.record(0).idle, 1.5 - scene.record(0).length, 1e-9);
  EXPECT_NEAR(scene.record(1).length, 1.5, 1e-9);

  // Who sends it on is held back again; it stays there.
  scene.go_on(2.0, where);
  EXPECT_EQ(scene.record(0).held_back, 2U);
  ASSERT_EQ(scene.stopped.size(), 2U);
  EXPECT_EQ(scene.stopped[1].pose.position, pose.position);
  // It can leave.
  const Pose rests = scene.stopped[1].pose;
  scene.go_on(4.0, [&](std::size_t r, double time) {
    return r == 1 ? where(1, time) : at(on_the_way(rests.position, from, time - 2.0));
  });
  EXPECT_EQ(scene.stopped.size(), 2U);
  EXPECT_NEAR(scene.record(0).length, 2 * (pose.position.x() - 1.5), 1e-9);
}

// To the walls of an empty room; on the ground the floor does not count.
TEST(MovingRobots, ClearanceIsTheDistanceToTheNearestSurface) {
  const BoxRoom room;
  frontlux::test::Random random(4);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const bool flies = i % 2 == 0;
    const RobotDescription robot = flies ? uav() : ugv();
    const auto point = [&] {
      const Vector3d low(0.55, 0.55, flies ? 0.45 : 0.75), high(5.45, 5.45, flies ? 2.55 : 0.75);
      Vector3d p;
      for (int a = 0; a < 3; ++a) p[a] = random.uniform(low[a], high[a]);
      return p;
    };
    const Vector3d from = point(), to = point();
    Moving scene(room, {robot}, {{from}});
    scene.go_on(7.0, [&](std::size_t, double time) { return at(on_the_way(from, to, time)); });
    const Vector3d half = robot.robot.travel.extents / 2;
    double expected = 1.0;
    for (const Vector3d& p : {from, to})  // the least distance to a wall is at an end
      for (int a = 0; a < (flies ? 3 : 2); ++a)
        expected = std::min({expected, p[a] - half[a], room.world.bounds.max()[a] - p[a] - half[a]});
    EXPECT_NEAR(scene.record().clearance, expected, 3e-4);
    EXPECT_LE(scene.record().clearance, expected + 1e-6) << "it is not safer than it is";
    EXPECT_EQ(scene.record().contacts.size(), 0U);
  }
  // Before it moves.
  EXPECT_NEAR(Moving(room, {uav()}, {{{0.5, 3, 1.5}}}).record().clearance, 0.1, 3e-4);
}

TEST(MovingRobots, SeparationIsTheLeastDistanceOfTwoBodies) {
  const BoxRoom room;
  const auto separation = [&](const Vector3d& a, const Vector3d& a_to, const Vector3d& b,
                              const Vector3d& b_to) {
    Moving scene(room, {uav(), uav()}, {{a}, {b}});
    scene.go_on(5.0, [&](std::size_t robot, double time) {
      return robot == 0 ? at(on_the_way(a, a_to, time)) : at(on_the_way(b, b_to, time));
    });
    return scene.robots.separation();
  };
  // Past each other, side by side.
  EXPECT_NEAR(separation({1, 2, 1.5}, {5, 2, 1.5}, {5, 3.2, 1.5}, {1, 3.2, 1.5}), 0.4, 1e-9);
  // At rest: from corner to corner.
  EXPECT_NEAR(separation({1, 1, 1}, {1, 1, 1.001}, {2.1, 2.2, 1}, {2.1, 2.2, 1.001}), std::hypot(0.3, 0.4),
              1e-9);
  // Head on, and they meet in the middle.
  EXPECT_EQ(separation({1, 2, 1.5}, {5, 2, 1.5}, {5, 2, 1.5}, {1, 2, 1.5}), 0.0);
  // At the start.
  EXPECT_NEAR(separation({1, 2, 1.5}, {1, 5, 1.5}, {2, 2, 1.5}, {5, 2, 1.5}), 0.2, 1e-9);
  EXPECT_EQ(Moving(room, {uav()}, {{{1, 1, 1}}}).robots.separation(),
            std::numeric_limits<double>::infinity());
}

TEST(MovingRobots, RefuseWhatCannotBe) {
  const BoxRoom room;
  EXPECT_REFUSED(Moving(room, {uav(), uav()}, {{{1, 1, 1}}}));
  EXPECT_REFUSED(Moving(room, {}, {{{1, 1, 1}}}));
  for (const double rate : {0.0, -10.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_REFUSED(Moving(room, {uav(rate)}, {{{1, 1, 1}}}));
  EXPECT_REFUSED(Moving(room, {uav()}, {{{1, 1, 1}}}, AtContact::kGoOn, {.sigma = -1.0}));
  RobotDescription blind = uav();
  blind.rows = 0;
  EXPECT_REFUSED(Moving(room, {blind}, {{{1, 1, 1}}}));
}

TEST(MovingRobots, StayWhileTheyAreNotActive) {
  const BoxRoom room;
  Moving scene(room, {small(planner::uav_description(), 5.0)}, {{Vector3d(2, 2, 1.5), 0.0}}, AtContact::kGoOn,
               {}, 1, {0.2, 2.0});
  const auto where = [&](std::size_t, double time) { return at({2, 2 + 0.5 * time, 1.5}); };
  scene.go_on(1.9, where);
  const Pose rests = scene.robots.believed(0);
  scene.robots.set_active(0, false);
  const double length = scene.record().length;
  scene.go_on(5.0, where);
  EXPECT_EQ(scene.record().length, length);
  EXPECT_EQ(scene.robots.believed(0).position, rests.position);
  scene.robots.set_active(0, true);
  scene.go_on(5.5, where);
  EXPECT_GT(scene.record().length, length + 1.0);
}

// What it was about to learn of where it is it knows then: it does not move when it follows `where` again.
TEST(MovingRobots, KnowWhereTheyAreWhileTheyAreNotActive) {
  const BoxRoom room;
  Moving scene(room, {small(planner::uav_description(), 5.0)}, {{Vector3d(2, 2, 1.5), 0.0}}, AtContact::kGoOn,
               {}, 1, {0.3, 2.0});
  scene.go_on(2.1, [&](std::size_t, double time) { return at({2, 2 + 0.5 * time, 1.5}); });
  scene.robots.set_active(0, false);
  const double length = scene.record().length;
  const Vector3d rests = scene.robots.believed(0).position;
  EXPECT_GT((rests - Vector3d(2, 2 + 0.5 * 2.0, 1.5)).norm(), 0.1);
  scene.go_on(3.1, [&](std::size_t, double time) { return at({2, 2 + 0.5 * time, 1.5}); });
  scene.robots.set_active(0, true);
  scene.go_on(3.5, [&](std::size_t, double) { return at(rests); });
  EXPECT_NEAR(scene.record().length, length, 1e-9);
}

}  // namespace
}  // namespace frontlux::sim
