#include "sim/mesh/box_mesh.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/planner/look_around.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/scan_world.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace frontlux::sim {
namespace {

// A room of 6 x 6 x 3 m whose floor lies right; `things` stand in it.
World room(std::initializer_list<std::pair<Eigen::Vector3f, Eigen::Vector3f>> things = {}) {
  World world;
  world.name = "test room";
  const auto add = [&](const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    test::add_box(world.mesh, {low, high});
  };
  add({0, 0, -0.05F}, {6, 6, 2.95F});
  for (const auto& [low, high] : things) add(low, high);
  world.bounds = {Eigen::Vector3d(-1.5, -1.5, -1.5), Eigen::Vector3d(7.5, 7.5, 4.5)};
  world.start = Eigen::Vector3d(3.15, 3.15, -0.05);
  return world;
}

const planner::Robot kUgv = planner::ugv(), kUav = planner::uav();

std::optional<planner::Pose> ugv_start(const GroundTruth& truth, const Eigen::Vector3d& around) {
  return find_starts(truth, around, std::vector{kUgv}).front();
}

GroundTruth truth_of(const World& world) { return {world, 0.3, free_start(world, 0.3, false)}; }

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

TEST(StartPose, RefusesStartsThatAreNone) {
  World world = room();
  const auto refusal = [&](bool faces_away) -> std::string {
    try {
      static_cast<void>(free_start(world, 0.3, faces_away));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  world.start.reset();
  EXPECT_NE(refusal(false).find("no start"), std::string::npos);
  world.start = Eigen::Vector3d(9, 3, 1);
  EXPECT_NE(refusal(false).find("9, 3, 1 is outside"), std::string::npos);
  world.start = Eigen::Vector3d(std::nan(""), 3, 1);
  EXPECT_NE(refusal(false).find("outside"), std::string::npos);
  // Inside of a locker, whose surface faces away from it, as the room's does not.
  world = room({{{1, 1, 0}, {2, 2, 2}}});
  world.start = Eigen::Vector3d(1.5, 1.5, 1.0);
  EXPECT_EQ(refusal(false), "");
  EXPECT_NE(refusal(true).find("within a solid"), std::string::npos);
}

TEST(StartPose, StandsOnTheFloorBesideObstacles) {
  // A table over the start: the UGV has to go beside it, the UAV above.
  const World world = room({{{2.4F, 2.4F, 0.35F}, {3.9F, 3.9F, 0.5F}}});
  const GroundTruth truth = truth_of(world);
  const auto starts = find_starts(truth, free_start(world, 0.3, false), std::vector{kUav, kUgv});
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
  const World world = room({{{2.4F, 2.4F, 0.35F}, {3.9F, 3.9F, 0.5F}}});
  const GroundTruth truth = truth_of(world);
  const auto why = [&](const planner::Robot& robot, double x, double y, double z) {
    return obstacle_at(truth, robot, {{x, y, z}}).value_or("");
  };
  EXPECT_EQ(why(kUgv, 1.05, 1.05, 0.75), "");
  EXPECT_NE(why(kUgv, 3.15, 3.15, 0.75).find("a surface passes through its voxel"), std::string::npos);
  EXPECT_EQ(why(kUgv, 1.05, 1.05, 1.05), "there is no floor under all of it");
  EXPECT_NE(why(kUgv, 0.1, 1.05, 0.75).find("cannot be reached"), std::string::npos);
  EXPECT_NE(why(kUav, 7.4, 1.05, 1.5).find("beyond the world's bounds"), std::string::npos);
  EXPECT_EQ(why(kUav, 1.05, 1.05, 1.35), "");
}

TEST(StartPose, FindsNothingWhereNothingFits) {
  World world = room();
  world.mesh = {};
  test::add_box(world.mesh, {Eigen::Vector3f(0, 0, -0.05F), Eigen::Vector3f(0.9F, 6, 2.95F)});
  world.start = Eigen::Vector3d(0.45, 3, 0.5);
  const GroundTruth truth(world, 0.3, *world.start);
  EXPECT_FALSE(ugv_start(truth, *world.start).has_value());
  EXPECT_TRUE(find_starts(truth, *world.start, std::vector{kUav})[0].has_value());
}

TEST(StartPose, BothRobotsStartInEveryBuiltInWorld) {
  for (const auto& [name, description] : built_in_worlds())
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      const World world = make_world(name, seed);
      const Eigen::Vector3d start = free_start(world, 0.3, true);
      const GroundTruth truth(world, 0.3, start);
      const auto starts = find_starts(truth, start, std::vector{kUgv, kUav});
      const auto &ugv = starts[0], &uav = starts[1];
      ASSERT_TRUE(ugv.has_value()) << name << seed;
      EXPECT_LT((ugv->position - start).head<2>().norm(), 0.3) << name << seed;
      ASSERT_TRUE(uav.has_value()) << name << seed;
      const KeyBox a = body_voxels(truth.lattice(), kUgv, *ugv), b = body_voxels(truth.lattice(), kUav, *uav);
      EXPECT_FALSE(intersection(a, b).has_value());
    }
}

TEST(StartPose, SeveralRobotsOfEachKindKeepApart) {
  planner::Robot small = kUgv;
  small.travel.extents = {0.5, 0.5, 0.4};
  small.travel.sensor_height = 0.5;
  const std::vector team{kUav, kUgv, small, kUav, kUgv};
  for (const auto& [name, description] : built_in_worlds()) {
    const World world = make_world(name, 2);
    const Eigen::Vector3d start = free_start(world, 0.3, true);
    const GroundTruth truth(world, 0.3, start);
    const auto starts = find_starts(truth, start, team);
    ASSERT_EQ(starts.size(), team.size());
    for (std::size_t i = 0; i < team.size(); ++i) {
      ASSERT_TRUE(starts[i].has_value()) << name << i;
      EXPECT_FALSE(obstacle_at(truth, team[i], *starts[i]).has_value());
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
    const auto two = find_starts(truth, start, std::vector{kUgv});
    EXPECT_EQ(starts[1]->position, two[0]->position);
  }
}

TEST(StartPose, ARobotOfNodesStartsInAFreeNode) {
  const planner::Robot nodes = planner::uav(planner::Method::kPaper);
  for (const auto& [name, description] : built_in_worlds()) {
    const World world = make_world(name, 2);
    const Eigen::Vector3d start = free_start(world, 0.3, true);
    const GroundTruth truth(world, 0.3, start);
    const auto starts = find_starts(truth, start, std::vector{kUgv, nodes});
    ASSERT_TRUE(starts[1].has_value()) << name;
    planner::Mapping mapping({.resolution = 0.3, .bounds = truth.bounds()});
    const auto bubble = start_bubble(truth, nodes, *starts[1]);
    for (const VoxelKey& key : bubble) EXPECT_EQ(truth.at(key), Truth::kFree);
    mapping.mark_free(bubble);
    // The judge: the corridor of nodes itself begins there.
    planner::TravelCorridor corridor(nodes.travel, truth.lattice(), truth.bounds());
    const Eigen::Vector3d& at = starts[1]->position;
    const VoxelKey key = truth.lattice().key(at).value();
    corridor.update({mapping.grid()}, key);
    EXPECT_EQ(corridor.state(), planner::CorridorState::kReady) << name << describe(corridor.state());
    EXPECT_TRUE(corridor.contains(key)) << name;
  }
  // Too low for a node of 1.2 m above 1.2 m: it starts where its box fits.
  World low = room();
  low.mesh = {};
  test::add_box(low.mesh, {Eigen::Vector3f(0, 0, -0.05F), Eigen::Vector3f(6, 6, 2.2F)});
  const GroundTruth truth = truth_of(low);
  const auto starts = find_starts(truth, {3.15, 3.15, 0.15}, std::vector{nodes});
  ASSERT_TRUE(starts[0].has_value());
  EXPECT_EQ(starts[0]->position, find_starts(truth, {3.15, 3.15, 0.15}, std::vector{kUav})[0]->position);
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
  const auto first = static_cast<std::uint32_t>(world.mesh.vertices.size());
  for (const auto& [y, z] : {std::pair{0.F, -0.05F}, {6.F, -0.05F}, {0.F, 2.95F}, {6.F, 2.95F}})
    world.mesh.vertices.emplace_back(3.9F, y, z);
  world.mesh.triangles.push_back({first, first + 1, first + 2});
  world.mesh.triangles.push_back({first + 1, first + 3, first + 2});
  const GroundTruth truth = truth_of(world);
  for (const auto& [robot, z, radius] : {std::tuple{kUgv, 0.75, 2.3}, std::tuple{kUav, 1.35, 1.0}}) {
    const bool drives = robot.travel.motion == planner::Motion::kPlane;
    const planner::Pose pose{{2.85, 3.15, z}};
    ASSERT_FALSE(obstacle_at(truth, robot, pose).has_value());
    const auto bubble = start_bubble(truth, robot, pose);
    const KeyBox body = body_voxels(truth.lattice(), robot, pose);
    std::set<VoxelKey> expected;
    for (int x = -30; x < 30; ++x)
      for (int y = -30; y < 30; ++y)
        for (int k = 0; k < 9; ++k) {
          const Eigen::Vector3d center = 0.3 * (Eigen::Vector3d(x, y, k) + Eigen::Vector3d::Constant(0.5));
          if (center.x() > 3.9 || center.x() < 0 || center.y() < 0 || center.y() > 6) continue;
          const VoxelKey key = make_key(Lattice::kOrigin + x, Lattice::kOrigin + y, Lattice::kOrigin + k);
          const Eigen::Vector3d off = center - pose.position;
          const bool in = drives ? off.head<2>().norm() <= radius && k < 3 : off.norm() <= radius;
          if (in || body.contains(key)) expected.insert(key);
        }
    EXPECT_EQ(std::set<VoxelKey>(bubble.begin(), bubble.end()), expected);
    planner::Mapping mapping({.resolution = 0.3, .bounds = truth.bounds()});
    EXPECT_TRUE(std::ranges::equal(mapping.mark_free(bubble).keys, bubble));
    EXPECT_EQ(mapping.grid().count()[1], bubble.size());
  }
}

TEST(Sweep, LooksFromEveryCubeThatHasAPlace) {
  const World world = room();
  const GroundTruth truth = truth_of(world);
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
    EXPECT_THROW(static_cast<void>(sweep(truth, kUav, {{3.15, 3.15, 1.35}}, spacing)), std::invalid_argument);
}

TEST(ScanWorld, IsTheSameForTheSameSeedAndStopsWhenTold) {
  const World world = room();
  const GroundTruth truth = truth_of(world);
  std::vector<View> views;
  for (const planner::Pose& pose : sweep(truth, kUgv, {{3.15, 3.15, 0.75}}, 1.5)) views.push_back({0, pose});
  const std::vector<planner::RobotDescription> team = {planner::ugv_description()};
  const Surface surface(world.mesh);
  const auto map = [&](std::uint64_t seed, std::size_t last) {
    planner::Mapping mapping({.resolution = 0.3, .bounds = truth.bounds()});
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
