#include "mesh/triangle_overlap.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/simulated_robots.hpp>

namespace frontlux::sim {
namespace {

using planner::Pose;

// A pane across x at 3.0 m, from y = 2 m on, two triangles of which a robot low and near y = 3 m meets one;
// in an otherwise empty world with a floor.
World pane(float top = 3.0F) {
  World world;
  world.name = "pane";
  world.mesh.vertices = {{0, 0, -0.05F}, {6, 0, -0.05F}, {0, 6, -0.05F}, {6, 6, -0.05F},
                         {3, 2, -0.05F}, {3, 6, -0.05F}, {3, 2, top},    {3, 6, top}};
  world.mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {4, 5, 6}, {5, 7, 6}};
  world.bounds = {Eigen::Vector3d(0, 0, -0.3), Eigen::Vector3d(6, 6, 3)};
  world.start = Eigen::Vector3d(1.05, 1.05, 0.75);
  return world;
}

bool same_bits(const planner::Scan& a, const planner::Scan& b) {
  return std::ranges::equal(a.ranges, b.ranges, [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
  });
}

TEST(SweptBox, MeetsTheTrianglesThatABoxInManyStepsMeets) {
  frontlux::test::Random random(3);
  int met = 0, passed = 0;
  for (int i = 0; i < 4'000; ++i) {
    const auto point = [&](double far) { return random.point(-far, far); };
    Eigen::Vector3d motion = point(2.0), half = point(0.4).cwiseAbs() + Eigen::Vector3d::Constant(0.05);
    if (random.one_in(4)) motion[random.below(3)] = 0.0;
    if (random.one_in(20)) motion.setZero();
    std::array<Eigen::Vector3d, 3> triangle{point(2.0), point(2.0), point(2.0)};
    if (random.one_in(4)) triangle[2] = triangle[1];
    if (random.one_in(4)) triangle[1].z() = triangle[0].z();
    const Eigen::Vector3d start = point(1.0);
    const bool swept = SweptBox({start - half, start + half}, motion).touches(triangle);
    const TriangleOverlap overlap(triangle);
    // A box of one step's size less is inside the swept space, one of a step more is around it.
    constexpr int kSteps = 400;
    const double step = motion.norm() / kSteps + 1e-9;
    bool inside = false, around = false;
    for (int k = 0; k <= kSteps; ++k) {
      const Eigen::Vector3d at = start + motion * (static_cast<double>(k) / kSteps);
      const Eigen::Vector3d more = half + Eigen::Vector3d::Constant(step);
      inside = inside || overlap.touches({at - half, at + half});
      around = around || overlap.touches({at - more, at + more});
    }
    EXPECT_TRUE(!inside || swept) << "case " << i;
    EXPECT_TRUE(!swept || around) << "case " << i;
    met += static_cast<int>(inside);
    passed += static_cast<int>(!around);
  }
  EXPECT_GT(met, 400);
  EXPECT_GT(passed, 400);
}

TEST(TriangleBvh, CountsAsALoopOverAllTriangles) {
  const World world = make_world("factory", 2);
  const TriangleBvh bvh(world.mesh);
  frontlux::test::Random random(4);
  std::uint64_t all = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d half = world.bounds.sizes() / 2;
    const Eigen::Vector3d at = world.bounds.center() + random.point(-1, 1).cwiseProduct(half),
                          motion = random.point(-1.5, 1.5);
    const SweptBox box({at - Eigen::Vector3d::Constant(0.4), at + Eigen::Vector3d::Constant(0.4)}, motion);
    std::uint64_t count = 0;
    for (std::size_t t = 0; t < world.mesh.triangles.size(); ++t)
      count += static_cast<std::uint64_t>(box.touches(corners_of(world.mesh, t)));
    EXPECT_EQ(bvh.count(box), count);
    all += count;
  }
  EXPECT_GT(all, 100U);
  EXPECT_EQ(TriangleBvh({}).count(SweptBox({Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 1)}, {1, 1, 1})),
            0U);
}

// Two robots, the one on the ground and the one in the air, beside the pane.
struct BesideThePane {
  World world = pane();
  GroundTruth truth{world, 0.3, *world.start};
  [[nodiscard]] SimulatedRobots robots(std::vector<planner::RobotDescription> team,
                                       const RangeErrors& errors = {}, std::uint64_t seed = 1,
                                       AtContact at_contact = AtContact::kGoOn) const {
    return SimulatedRobots(world, truth, std::move(team), errors, seed, at_contact);
  }
};

// Drives, and tells what the robot ran into.
std::uint64_t contacts_of(SimulatedRobots& robots, std::size_t robot, const Pose& viewpoint) {
  const std::uint64_t before = robots.contacts();
  EXPECT_TRUE(robots.drive(robot, viewpoint).has_value());
  return robots.contacts() - before;
}

TEST(SimulatedRobots, CountWhatTheyRunInto) {
  const BesideThePane scene;
  SimulatedRobots robots = scene.robots({planner::ugv_description(), planner::uav_description()});
  const auto drive = [&](std::size_t robot, double x, double y, double z) {
    return contacts_of(robots, robot, {{x, y, z}});
  };
  // Appears, turns, and goes beside the pane: nothing. The pane lies on a face, x = 10 voxels.
  EXPECT_EQ(drive(0, 1.05, 3.15, 0.75), 0U);
  EXPECT_EQ(drive(0, 1.05, 3.15, 0.75), 0U);
  EXPECT_EQ(drive(0, 2.25, 3.15, 0.75), 0U);
  // 0.5 m to each side: at 2.55 it is 5 cm into the pane.
  EXPECT_EQ(drive(0, 2.55, 3.15, 0.75), 1U);
  EXPECT_EQ(drive(0, 2.49, 3.15, 0.75), 1U);
  EXPECT_EQ(drive(0, 2.49, 3.15, 0.75), 0U);
  // Right through, and back around the end.
  EXPECT_EQ(drive(0, 4.05, 3.15, 0.75), 1U);
  EXPECT_EQ(drive(0, 4.05, 1.05, 0.75), 0U);
  EXPECT_EQ(drive(0, 1.05, 1.05, 0.75), 0U);
  EXPECT_EQ(robots.contacts(), 3U);
  // The aerial one: 0.4 m to each side, and down to the floor.
  EXPECT_EQ(drive(1, 1.05, 3.15, 1.35), 0U);
  EXPECT_EQ(drive(1, 2.59, 3.15, 1.35), 0U);
  EXPECT_EQ(drive(1, 2.61, 3.15, 1.35), 1U);
  EXPECT_EQ(drive(1, 1.05, 3.15, 0.45), 1U);  // away from the pane
  // Both triangles of the floor meet where x + y = 6, away from here.
  EXPECT_EQ(drive(1, 1.05, 3.15, 0.3), 1U);
  EXPECT_EQ(robots.contacts(), 6U);
}

// Half a metre from the upright edge of the pane, where only a corner of the box around it meets something.
TEST(SimulatedRobots, CountContactsOfTheTrueShape) {
  const BesideThePane scene;
  for (const planner::BodyShape shape :
       {planner::BodyShape::kBox, planner::BodyShape::kCylinder, planner::BodyShape::kSphere}) {
    planner::RobotDescription round = planner::uav_description();
    round.robot.travel.shape = shape;
    SimulatedRobots robots = scene.robots({round});
    const double off = 0.5 / std::numbers::sqrt2, x = 3 + off, y = 2 - off;
    EXPECT_EQ(contacts_of(robots, 0, {{x - 1, y - 1, 1.35}}), 0U);
    EXPECT_EQ(contacts_of(robots, 0, {{x + 1, y + 1, 1.35}}) > 0, shape == planner::BodyShape::kBox);
    EXPECT_GT(contacts_of(robots, 0, {{3 - off, y + 1, 1.35}}), 0U) << "through the pane";
  }
}

TEST(SimulatedRobots, ErrorsDependOnSeedRobotAndNumberOfItsScans) {
  const BesideThePane scene;
  const std::vector<planner::RobotDescription> team(2, planner::ugv_description());
  const RangeErrors errors{.sigma = 0.05, .dropout = 0.1};
  SimulatedRobots a = scene.robots(team, errors, 7), b = scene.robots(team, errors, 7),
                  c = scene.robots(team, errors, 8);
  const Pose pose{{1.05, 1.05, 0.75}};
  const planner::Scan first = *a.drive(0, pose), second = *a.drive(0, pose), other = *a.drive(1, pose);
  EXPECT_FALSE(same_bits(first, second));
  EXPECT_FALSE(same_bits(first, other));
  // In another order.
  EXPECT_TRUE(same_bits(*b.drive(1, pose), other));
  EXPECT_TRUE(same_bits(*b.drive(0, pose), first));
  EXPECT_TRUE(same_bits(*b.drive(0, pose), second));
  EXPECT_FALSE(same_bits(*c.drive(0, pose), first));
  // Without errors it is what the sensor sees.
  SimulatedRobots exact = scene.robots({planner::uav_description()});
  EXPECT_TRUE(same_bits(*exact.drive(0, pose),
                        sense(Surface(scene.world.mesh), sensor_of(planner::uav_description()), pose, 5)));
}

TEST(SimulatedRobots, StayWhereABumperStopsThem) {
  const BesideThePane scene;
  SimulatedRobots robots = scene.robots({planner::ugv_description()}, {}, 1, AtContact::kStay);
  EXPECT_TRUE(robots.drive(0, {{2.25, 3.15, 0.75}}).has_value());
  EXPECT_FALSE(robots.drive(0, {{4.05, 3.15, 0.75}}).has_value());
  // It is still on this side of the pane.
  EXPECT_TRUE(robots.drive(0, {{1.05, 3.15, 0.75}}).has_value());
  EXPECT_EQ(robots.contacts(), 0U);
}

TEST(SimulatedRobots, RefuseWhatIsNoViewpointOrNoRobot) {
  const BesideThePane scene;
  SimulatedRobots robots = scene.robots({planner::ugv_description()});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_REFUSED(robots.drive(1, {{1, 1, 0.75}}));
  for (const Pose& bad : {Pose{{1, nan, 0.75}}, Pose{{1, 1, 1e9}}, Pose{{1, 1, 0.75}, nan}})
    EXPECT_REFUSED(robots.drive(0, bad));
  EXPECT_EQ(robots.contacts(), 0U);
}

}  // namespace
}  // namespace frontlux::sim
