#include "sim/mesh/box_mesh.hpp"
#include "sim/world/place.hpp"
#include "support/complaint.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/continuous_exploration.hpp>
#include <frontlux/planner/look_around.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/sim/scan_world.hpp>

namespace frontlux::sim {
namespace {

// A room of 6 x 6 x 3 m whose floor lies right; `things` stand in it.
World room(std::initializer_list<std::pair<Eigen::Vector3f, Eigen::Vector3f>> things = {}) {
  World world;
  world.name = "test room";
  test::add_box(world.mesh, {Eigen::Vector3f(0, 0, -0.05F), Eigen::Vector3f(6, 6, 2.95F)});
  for (const auto& [low, high] : things) test::add_box(world.mesh, {low, high});
  world.bounds = {Eigen::Vector3d(-1.5, -1.5, -1.5), Eigen::Vector3d(7.5, 7.5, 4.5)};
  world.start = Eigen::Vector3d(3.15, 3.15, -0.05);
  return world;
}

const planner::Robot kUgv = planner::ugv(), kUav = planner::uav();

using frontlux::test::expect_complaint;
using test::Place;

TEST(StartPose, LiftsAStartOnTheFloorIntoTheRoom) {
  for (const double resolution : {0.05, 0.1, 0.3}) {
    const Eigen::Vector3d start = free_start(room(), resolution, false);
    EXPECT_DOUBLE_EQ(start.x(), 3.15);
    EXPECT_GT(start.z(), -0.05);
    EXPECT_LE(start.z(), resolution / 2 + 1e-9);
  }
  for (const auto& [name, description] : built_in_worlds())
    for (const double resolution : {0.05, 0.1, 0.2, 0.3}) {
      const World world = make_world(name, 3);
      EXPECT_NEAR(free_start(world, resolution, true).z(), resolution == 0.05 ? -0.025 : resolution / 2, 1e-6)
          << name << " " << resolution;
    }
}

// Half a voxel above the floor its box of voxels would reach into it.
TEST(StartPose, LeavesRoomForTheMargin) {
  planner::Robot small = planner::uav();
  small.travel.extents = {0.5, 0.5, 0.3};
  small.travel.min_height = 0.15;
  for (const double margin : {0.0, 0.05}) {
    small.travel.margin = margin;
    const GroundTruth truth(room(), 0.3, {3.15, 3.15, 0.15});
    const auto starts = find_starts(truth, {3.15, 3.15, 0.15}, {{small}});
    ASSERT_TRUE(starts[0]);
    const VoxelKey key = truth.lattice().key(starts[0]->position).value();
    EXPECT_TRUE(all_of(voxels_of_cell(small.travel, truth.lattice(), key),
                       [&](const VoxelKey& voxel) { return truth.at(voxel) == Truth::kFree; }));
    EXPECT_NEAR(starts[0]->position.z(), margin > 0.0 ? 0.45 : 0.15, 1e-9);
  }
}

// However wide that is: a robot that does not know to be free what planning asks for would never move.
TEST(StartPose, KnowsTheRoomThatPlanningKeepsFree) {
  const GroundTruth truth(room(), 0.3, {3.15, 3.15, 0.15});
  planner::Robot wide = planner::uav(), wary = planner::uav();
  wide.travel.extents = {1.5, 1.5, 0.5};
  wide.travel.margin = 0.05;
  wary.travel.extents = {0.5, 0.5, 0.3};
  wary.travel.margin = 1.1;
  for (planner::Robot robot : {wide, wary}) {
    robot.travel.min_height = 0.25;
    const auto starts = find_starts(truth, {3.15, 3.15, 0.15}, {{robot}});
    ASSERT_TRUE(starts[0]);
    const auto bubble = start_bubble(truth, robot, *starts[0]);
    const VoxelKey at = truth.lattice().key(starts[0]->position).value();
    planner::BodyStencil(robot.travel, 0.3).for_each(at, [&](const VoxelKey& key) {
      EXPECT_TRUE(std::ranges::binary_search(bubble, key)) << key.x - at.x << " " << key.y - at.y;
    });
  }
}

// From the corner of a locker: 0.42 m are enough for a radius of 0.4 m, 0.38 m are not.
TEST(StartPose, RoundBodiesMayStandNearerToCorners) {
  const GroundTruth truth(room({{{1, 1, 0}, {2, 2, 2}}}), 0.1, {3.15, 3.15, 0.15});
  planner::Robot robot = planner::uav();
  robot.travel.min_height = 0.0;
  const auto has_room = [&](planner::BodyShape shape, double off) {
    robot.travel.shape = shape;
    return !obstacle_at(truth, robot, {{2 + off, 2 + off, 1.05}}).has_value();
  };
  EXPECT_FALSE(has_room(planner::BodyShape::kBox, 0.3));
  EXPECT_TRUE(has_room(planner::BodyShape::kBox, 0.4));
  for (const planner::BodyShape shape : {planner::BodyShape::kCylinder, planner::BodyShape::kSphere}) {
    EXPECT_TRUE(has_room(shape, 0.3));
    EXPECT_FALSE(has_room(shape, 0.27));
  }
}

TEST(StartPose, RefusesStartsThatAreNone) {
  World world = room();
  const auto refuses = [&](bool faces_away, const std::string& part) {
    expect_complaint<std::runtime_error>([&] { static_cast<void>(free_start(world, 0.3, faces_away)); },
                                         {part});
  };
  world.start.reset();
  refuses(false, "no start");
  world.start = Eigen::Vector3d(9, 3, 1);
  refuses(false, "9, 3, 1 is outside");
  world.start = Eigen::Vector3d(std::nan(""), 3, 1);
  refuses(false, "outside");
  // Inside of a locker, whose surface faces away from it, as the room's does not.
  world = room({{{1, 1, 0}, {2, 2, 2}}});
  world.start = Eigen::Vector3d(1.5, 1.5, 1.0);
  EXPECT_NO_THROW(static_cast<void>(free_start(world, 0.3, false)));
  refuses(true, "within a solid");
}

TEST(StartPose, StandsOnTheFloorBesideObstacles) {
  // A table over the start: the UGV has to go beside it, the UAV above.
  const Place place(room({{{2.4F, 2.4F, 0.35F}, {3.9F, 3.9F, 0.5F}}}), false);
  const GroundTruth& truth = place.truth;
  const auto starts = place.starts({kUav, kUgv});
  const auto &uav = starts[0], &ugv = starts[1];
  ASSERT_TRUE(ugv.has_value());
  EXPECT_NEAR(ugv->position.z(), 0.75, 1e-9);
  EXPECT_FALSE(obstacle_at(truth, kUgv, *ugv).has_value());
  // By hand: the voxels of its body, two on each side of the middle one, clear the table's and the walls.
  const auto apart = [](double a, double b) { return std::abs(a - b); };
  const double off = std::max(apart(ugv->position.x(), 3.15), apart(ugv->position.y(), 3.15));
  EXPECT_NEAR(off, 1.5, 1e-6);
  ASSERT_TRUE(uav.has_value());
  EXPECT_GE(uav->position.z(), 1.2);
  EXPECT_FALSE(obstacle_at(truth, kUav, *uav).has_value());
}

TEST(StartPose, NamesTheObstacle) {
  const Place place(room({{{2.4F, 2.4F, 0.35F}, {3.9F, 3.9F, 0.5F}}}), false);
  const auto why = [&](const planner::Robot& robot, double x, double y, double z) {
    return obstacle_at(place.truth, robot, {{x, y, z}}).value_or("");
  };
  EXPECT_EQ(why(kUgv, 1.05, 1.05, 0.75), "");
  frontlux::test::expect_parts(why(kUgv, 3.15, 3.15, 0.75), {"a surface passes through its voxel"});
  EXPECT_EQ(why(kUgv, 1.05, 1.05, 1.05), "there is no floor under all of it");
  frontlux::test::expect_parts(why(kUgv, 0.1, 1.05, 0.75), {"cannot be reached"});
  frontlux::test::expect_parts(why(kUav, 7.4, 1.05, 1.5), {"beyond the world's bounds"});
  EXPECT_EQ(why(kUav, 1.05, 1.05, 1.35), "");
}

TEST(StartPose, FindsNothingWhereNothingFits) {
  World world = room();
  world.mesh = {};
  test::add_box(world.mesh, {Eigen::Vector3f(0, 0, -0.05F), Eigen::Vector3f(0.9F, 6, 2.95F)});
  world.start = Eigen::Vector3d(0.45, 3, 0.5);
  const Place place(world, false);
  EXPECT_FALSE(place.starts({kUgv})[0].has_value());
  EXPECT_TRUE(place.starts({kUav})[0].has_value());
}

TEST(StartPose, BothRobotsStartInEveryBuiltInWorld) {
  for (const auto& [name, description] : built_in_worlds())
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(seed));
      const Place place(name, seed);
      const auto starts = place.starts({kUgv, kUav});
      const auto &ugv = starts[0], &uav = starts[1];
      ASSERT_TRUE(ugv.has_value());
      EXPECT_LT((ugv->position - place.start).head<2>().norm(), 0.3);
      ASSERT_TRUE(uav.has_value());
      const Lattice& lattice = place.truth.lattice();
      EXPECT_FALSE(
          intersection(body_voxels(lattice, kUgv, *ugv), body_voxels(lattice, kUav, *uav)).has_value());
    }
}

TEST(StartPose, SeveralRobotsOfEachKindKeepApart) {
  planner::Robot small = kUgv;
  small.travel.extents = {0.5, 0.5, 0.4};
  small.travel.sensor_height = 0.5;
  const std::vector team{kUav, kUgv, small, kUav, kUgv};
  for (const auto& [name, description] : built_in_worlds()) {
    const Place place(name, 2);
    const auto starts = place.starts(team);
    ASSERT_EQ(starts.size(), team.size());
    for (std::size_t i = 0; i < team.size(); ++i) {
      ASSERT_TRUE(starts[i].has_value()) << name << i;
      EXPECT_FALSE(obstacle_at(place.truth, team[i], *starts[i]).has_value());
      // By their true extents in metres, not by voxels.
      const auto body = [&](std::size_t k) {
        const Eigen::Vector3d half = team[k].travel.extents / 2;
        Eigen::AlignedBox3d box(starts[k]->position - half, starts[k]->position + half);
        if (team[k].travel.motion == planner::Motion::kPlane) {
          box.min().z() = 0.0;
          box.max().z() = team[k].travel.sensor_height;
        }
        return box;
      };
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_TRUE(body(i).intersection(body(k)).isEmpty()) << name << " " << i << " " << k;
      if (team[i].travel.motion == planner::Motion::kSpace) {
        EXPECT_GE(starts[i]->position.z(), 1.2);
      }
    }
    // The first of a kind starts where it would without the others of its kind.
    EXPECT_EQ(starts[1]->position, place.starts({kUgv})[0]->position);
  }
}

TEST(StartPose, BodiesDoNotTouchAtFineVoxels) {
  planner::Robot ugv = kUgv, uav = kUav;
  ugv.travel.extents = {0.6, 0.5, 0.4};
  ugv.travel.sensor_height = 0.5;
  uav.travel.extents = {0.5, 0.5, 0.3};
  uav.travel.min_height = 0.15;
  const std::vector team{ugv, uav, uav};
  const auto starts = Place(make_world("room", 1), true, 0.1).starts(team);
  for (std::size_t i = 0; i < team.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto body = [&](std::size_t r) {
        return planner::body_of(team[r].travel).translated(starts[r].value().position);
      };
      EXPECT_GE(body(i).exteriorDistance(body(k)), planner::kSeparation - 1e-9) << i << " and " << k;
    }
}

TEST(StartPose, ARobotOfNodesStartsInAFreeNode) {
  const planner::Robot nodes = planner::uav(planner::Method::kPaper);
  for (const auto& [name, description] : built_in_worlds()) {
    SCOPED_TRACE(name);
    const Place place(name, 2);
    const GroundTruth& truth = place.truth;
    const auto starts = place.starts({kUgv, nodes});
    ASSERT_TRUE(starts[1].has_value());
    planner::Mapping mapping({.resolution = 0.3, .bounds = truth.bounds()});
    const auto bubble = start_bubble(truth, nodes, *starts[1]);
    for (const VoxelKey& key : bubble) EXPECT_EQ(truth.at(key), Truth::kFree);
    mapping.mark_free(bubble);
    // The judge: the corridor of nodes itself begins there.
    planner::TravelCorridor corridor(nodes.travel, truth.lattice(), truth.bounds());
    const VoxelKey key = truth.lattice().key(starts[1]->position).value();
    corridor.update({mapping.grid()}, key);
    EXPECT_EQ(corridor.state(), planner::CorridorState::kReady) << describe(corridor.state());
    EXPECT_TRUE(corridor.contains(key));
  }
  // Too low for a node of 1.2 m above 1.2 m: it starts where its box fits.
  World low = room();
  low.mesh = {};
  test::add_box(low.mesh, {Eigen::Vector3f(0, 0, -0.05F), Eigen::Vector3f(6, 6, 2.2F)});
  const Place place(low, false);
  const auto starts = place.starts({nodes});
  ASSERT_TRUE(starts[0].has_value());
  EXPECT_EQ(starts[0]->position, place.starts({kUav})[0]->position);
}

TEST(Sweep, LooksAroundAsOftenAsTheSensorNeeds) {
  EXPECT_EQ(planner::look_around(kUgv.view, {}).size(), 1U);
  EXPECT_EQ(planner::look_around(kUav.view, {}).size(), 4U);
  FieldOfView narrow = kUav.view;
  narrow.horizontal = 0.5;
  const auto poses = planner::look_around(narrow, {{1, 2, 3}, 0.25});
  ASSERT_EQ(poses.size(), 13U);
  EXPECT_EQ(poses[0].yaw, 0.25);
  for (const planner::Pose& pose : poses) EXPECT_EQ(pose.position, Eigen::Vector3d(1, 2, 3));
  // Every azimuth is in view of one of them.
  for (double azimuth = 0.0; azimuth < 6.3; azimuth += 0.01) {
    const Eigen::Vector3d offset(std::cos(azimuth), std::sin(azimuth), 0.0);
    EXPECT_TRUE(std::ranges::any_of(poses, [&](const planner::Pose& pose) {
      return narrow.contains(offset, pose.yaw);
    })) << azimuth;
  }
}

TEST(StartBubble, StaysOnThisSideOfWalls) {
  // A screen without thickness, exactly on voxel faces, 0.9 m from the robot.
  World world = room();
  test::add_quad(world.mesh, {3.9F, 0, -0.05F}, {3.9F, 6, -0.05F}, {3.9F, 6, 2.95F}, {3.9F, 0, 2.95F});
  const Place place(world, false);
  const GroundTruth& truth = place.truth;
  for (const auto& [robot, z, radius] : {std::tuple{kUgv, 0.75, 2.3}, std::tuple{kUav, 1.35, 1.0}}) {
    const bool drives = robot.travel.motion == planner::Motion::kPlane;
    const planner::Pose pose{{2.85, 3.15, z}};
    ASSERT_FALSE(obstacle_at(truth, robot, pose).has_value());
    const auto bubble = start_bubble(truth, robot, pose);
    const KeyBox body = body_voxels(truth.lattice(), robot, pose);
    std::set<VoxelKey> expected;
    for_each_key({frontlux::test::key_at(-30, -30, 0), frontlux::test::key_at(29, 29, 8)},
                 [&, reach = radius](const VoxelKey& key) {
                   const Eigen::Vector3d center = truth.lattice().exact_center(key);
                   if (center.x() > 3.9 || center.x() < 0 || center.y() < 0 || center.y() > 6) return;
                   const Eigen::Vector3d off = center - pose.position;
                   const bool in =
                       drives ? off.head<2>().norm() <= reach && center.z() < 0.9 : off.norm() <= reach;
                   if (in || body.contains(key)) expected.insert(key);
                 });
    EXPECT_EQ(std::set<VoxelKey>(bubble.begin(), bubble.end()), expected);
    planner::Mapping mapping({.resolution = 0.3, .bounds = truth.bounds()});
    EXPECT_TRUE(std::ranges::equal(mapping.mark_free(bubble).keys, bubble));
    EXPECT_EQ(mapping.grid().count()[1], bubble.size());
  }
}

TEST(Sweep, LooksFromEveryCubeThatHasAPlace) {
  const Place place(room(), false);
  const GroundTruth& truth = place.truth;
  const auto ugv = sweep(truth, kUgv, {{3.15, 3.15, 0.75}}, 1.5);
  // 20 x 20 cells inside; cubes of 5 voxels from -1.5 m on; the robot's middle keeps 2 voxels from the walls.
  EXPECT_EQ(ugv.size(), 16U);
  const auto uav = sweep(truth, kUav, {{3.15, 3.15, 1.35}}, 1.5);
  EXPECT_EQ(uav.size() % 4, 0U);
  EXPECT_EQ(uav.size(), 4 * 16 * 2U);
  for (const auto& views : {ugv, uav})
    for (const planner::Pose& view : views) {
      EXPECT_FALSE(obstacle_at(truth, view.position.z() == 0.75 ? kUgv : kUav, view).has_value());
      EXPECT_TRUE(
          Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(6, 6, 2.95)).contains(view.position));
    }
  EXPECT_NEAR(uav[3].yaw, 1.5 * std::numbers::pi, 1e-12);
  for (const double spacing : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_REFUSED(sweep(truth, kUav, {{3.15, 3.15, 1.35}}, spacing));
}

TEST(ScanWorld, IsTheSameForTheSameSeedAndStopsWhenTold) {
  const Place place(room(), false);
  std::vector<View> views;
  for (const planner::Pose& pose : sweep(place.truth, kUgv, {{3.15, 3.15, 0.75}}, 1.5))
    views.push_back({0, pose});
  const std::vector<planner::RobotDescription> team = {planner::ugv_description()};
  const Surface surface(place.world.mesh);
  const auto map = [&](std::uint64_t seed, std::size_t last) {
    planner::Mapping mapping({.resolution = 0.3, .bounds = place.truth.bounds()});
    const std::size_t done =
        scan_world(surface, team, views, {.errors = {.sigma = 0.3, .dropout = 0.1}, .seed = seed}, mapping,
                   [&](std::size_t n) { return n < last; });
    EXPECT_EQ(done, std::min(last, views.size()));
    return mapping.grid();
  };
  EXPECT_TRUE(map(1, 100) == map(1, 100));
  EXPECT_FALSE(map(1, 100) == map(2, 100));
  EXPECT_FALSE(map(1, 100) == map(1, 2));
}

}  // namespace
}  // namespace frontlux::sim
