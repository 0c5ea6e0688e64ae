// Goals against plain formulas: every cell and every frontier asked one by one, distances by a flood fill.

#include "planner/goal/goal_truth.hpp"
#include "support/voxel_keys.hpp"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::test {
namespace {

TEST(GoalSelection, GroundRobotTakesTheCellWithTheBestViewQuality) {
  for (const TravelDistance distance : {TravelDistance::kPath, TravelDistance::kStraight})
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      GoalRoom room(26, 6, seed);
      room.clear(13, 13, 2);
      const auto caster = make_grid_ray_caster(room.grid);
      TeamMember member = ground_robot();
      member.options.distance = distance;
      member.options.rendering.samples = ViewQualityOptions::kAll;
      GoalSelection selection({member}, room.grid.lattice(), room.bounds());
      const Pose pose = room.pose(13, 13, 2);
      const auto frontiers = room.frontiers();
      const TeamGoals team = selection.select(*caster, {room.grid}, frontiers, {&pose, 1});
      const auto cells = selection.corridor(0).cells();
      ASSERT_GT(cells.size(), 40U);
      const auto assigned = naive_assigned(*caster, kResolution, frontiers, cells, member.robot.view);
      EXPECT_EQ(team.goals[0].assigned, assigned.size());
      EXPECT_EQ(team.unassigned, frontiers.size() - assigned.size());
      const VoxelKey start = room.key(13, 13, 2);
      const auto steps = naive_steps(cells, start);
      ASSERT_EQ(steps.size(), cells.size());
      std::optional<Found> best;
      for (const VoxelKey& cell : cells) {
        const double d = distance == TravelDistance::kPath ? steps.at(cell) * kResolution
                                                           : offset_between(start, cell, kResolution).norm();
        if (d < 0.59) continue;
        const auto gain =
            static_cast<double>(naive_seen(*caster, kResolution, cell, assigned, member.robot.view).size());
        const double quality = worth(gain, d);
        // Sums of equal cells in another order differ in the last digits.
        if (gain > 0 && (!best || quality > best->quality * (1 + 1e-9))) best = Found{cell, gain, quality, 0};
      }
      expect_goal(team.goals[0], best);
      EXPECT_EQ(team.goals[0].state, GoalState::kAssigned);
      const auto rendered = selection.rendered_cells(0);
      ASSERT_EQ(rendered.size(), cells.size());
      for (std::size_t i = 0; i < rendered.size(); i += 17)
        EXPECT_EQ(
            rendered[i].gain,
            static_cast<double>(
                naive_seen(*caster, kResolution, rendered[i].cell, assigned, member.robot.view).size()));
    }
}

TEST(GoalSelection, DrawnTargetsLeadToACellWhoseGainIsCounted) {
  GoalRoom room(26, 6, 3);
  room.clear(13, 13, 2);
  const auto caster = make_grid_ray_caster(room.grid);
  const Pose pose = room.pose(13, 13, 2);
  const auto frontiers = room.frontiers();
  for (const int refined : {1, 5, 200}) {
    TeamMember member = ground_robot();
    member.options.rendering.samples = 2;
    member.options.refined = refined;
    GoalSelection selection({member}, room.grid.lattice(), room.bounds());
    const Goal goal = selection.select(*caster, {room.grid}, frontiers, {&pose, 1}).goals[0];
    ASSERT_TRUE(goal.pose);
    const std::vector<VoxelKey> assigned(selection.targets(0).begin(), selection.targets(0).end());
    EXPECT_EQ(
        goal.gain,
        static_cast<double>(naive_seen(*caster, kResolution, goal.cell, assigned, member.robot.view).size()));
    EXPECT_EQ(goal.standard_error, 0.0);
  }
}

TEST(GoalSelection, PaperModeCountsHitsAmongTheDrawn) {
  GoalRoom room(26, 6, 4);
  room.clear(13, 13, 2);
  const auto caster = make_grid_ray_caster(room.grid);
  TeamMember member = ground_robot();
  member.options = goal_options(member.robot, Method::kPaper);
  member.options.rendering.samples = 5;
  GoalSelection selection({member}, room.grid.lattice(), room.bounds());
  const Pose pose = room.pose(13, 13, 2);
  const Goal goal = selection.select(*caster, {room.grid}, room.frontiers(), {&pose, 1}).goals[0];
  ASSERT_TRUE(goal.pose);
  double best = 0;
  for (const auto& cell : selection.rendered_cells(0)) {
    EXPECT_LE(cell.gain, 5.0);
    EXPECT_EQ(cell.gain, cell.hits);
    const double d = offset_between(room.key(13, 13, 2), cell.cell, kResolution).norm();
    EXPECT_NEAR(cell.quality, cell.hits * std::exp(-0.1386 * d), 1e-5);
    if (d > 0.59) best = std::max(best, cell.quality);
  }
  EXPECT_EQ(goal.quality, best);
}

TEST(GoalSelection, AerialRobotTakesTheCellWithTheBestWindow) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    GoalRoom room(15, 9, seed);
    room.clear(7, 7, 4);
    const auto caster = make_grid_ray_caster(room.grid);
    TeamMember member = aerial_robot();
    member.options.rendering.samples = 3;
    member.options.refined = kAllCells;
    member.options.prune = false;
    member.options.surroundings = 1;
    GoalSelection selection({member}, room.grid.lattice(), room.bounds());
    const Pose pose = room.pose(7, 7, 4);
    const auto frontiers = room.frontiers();
    const TeamGoals team = selection.select(*caster, {room.grid}, frontiers, {&pose, 1});
    const auto cells = selection.corridor(0).cells();
    ASSERT_GT(cells.size(), 40U);
    const auto assigned = naive_assigned(*caster, kResolution, frontiers, cells, member.robot.view);
    EXPECT_EQ(team.goals[0].assigned, assigned.size());
    const VoxelKey start = room.key(7, 7, 4);
    const auto steps = naive_steps(cells, start);
    std::set<std::array<int, 3>> cubes;
    std::optional<Found> best;
    std::size_t viewpoints = 0;
    for (const VoxelKey& cell : cells) {
      const bool first = cubes.insert({cell.x / 2, cell.y / 2, cell.z / 2}).second;
      const Eigen::Vector3d away = offset_between(start, cell, 1.0).cwiseAbs();
      if (!first && away.maxCoeff() > 2) continue;
      ++viewpoints;
      if (steps.at(cell) < 2) continue;
      const auto seen = naive_seen(*caster, kResolution, cell, assigned, member.robot.view);
      Found found = best_yaw(cell, seen, member.robot.view.horizontal, nullptr);
      found.quality = worth(found.gain, steps.at(cell) * kResolution);
      if (found.gain > 0 && (!best || found.quality > best->quality * (1 + 1e-9))) best = found;
    }
    EXPECT_EQ(selection.rendered_cells(0).size(), viewpoints);
    expect_goal(team.goals[0], best);
    ASSERT_TRUE(best);
    EXPECT_NEAR(team.goals[0].pose->yaw, best->yaw, 1e-9);
  }
}

// What a team decides, with what it drew, on any caster and number of threads.
void expect_same(const TeamGoals& a, const TeamGoals& b, bool rays = true) {
  EXPECT_EQ(a.frontiers, b.frontiers);
  EXPECT_EQ(a.unassigned, b.unassigned);
  if (rays) {
    EXPECT_EQ(a.rays, b.rays);
  }
  ASSERT_EQ(a.goals.size(), b.goals.size());
  for (std::size_t r = 0; r < a.goals.size(); ++r) {
    const Goal &x = a.goals[r], &y = b.goals[r];
    ASSERT_EQ(x.pose.has_value(), y.pose.has_value());
    if (x.pose) {
      EXPECT_EQ(x.pose->position, y.pose->position);
      EXPECT_EQ(x.pose->yaw, y.pose->yaw);
      EXPECT_EQ(x.cell, y.cell);
      EXPECT_EQ(x.gain, y.gain);
      EXPECT_EQ(x.quality, y.quality);
    }
    EXPECT_EQ(x.state, y.state);
    EXPECT_EQ(x.reason, y.reason);
    EXPECT_EQ(x.assigned, y.assigned);
    EXPECT_EQ(x.released, y.released);
    EXPECT_EQ(x.received, y.received);
    EXPECT_EQ(x.uncovered, y.uncovered);
  }
}

std::vector<std::vector<TeamMember>> teams() {
  std::vector<TeamMember> drawn = {ground_robot(), aerial_robot()};
  for (TeamMember& member : drawn) {
    member.options.rendering.samples = 6;
    member.options.refined = 10;
  }
  std::vector<TeamMember> paper = {ground_robot(), aerial_robot(Method::kPaper)};
  paper[0].options = goal_options(paper[0].robot, Method::kPaper);
  std::vector<TeamMember> nearest = {ground_robot(), aerial_robot()};
  for (TeamMember& member : nearest) member.options.rule = GoalRule::kNearest;
  return {drawn, paper, nearest};
}

TEST(GoalSelection, SameGoalOnOneAndTwoThreadsAndWithEveryExactCaster) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    GoalRoom room(40, 9, seed);
    room.clear(10, 10, 2);
    room.clear(30, 30, 5);
    const std::array poses = {room.pose(10, 10, 2), room.pose(30, 30, 5)};
    const auto frontiers = room.frontiers();
    for (const auto& team : teams()) {
      const auto decide = [&](const RayCaster& caster, int threads) {
        tbb::task_arena arena(threads);
        return arena.execute([&] {
          GoalSelection selection(team, room.grid.lattice(), room.bounds());
          return selection.select(caster, {room.grid}, frontiers, poses);
        });
      };
      const auto grid = make_grid_ray_caster(room.grid), fast = make_ray_caster(room.grid);
      const TeamGoals one = decide(*grid, 1);
      EXPECT_TRUE(one.goals[0].pose);
      expect_same(one, decide(*grid, 2));
      expect_same(one, decide(*fast, 1));
      expect_same(one, decide(*fast, 2));
    }
  }
}

TEST(GoalSelection, FollowsAMapAsIfItHadNotSeenItBefore) {
  for (const auto& team : teams()) {
    GoalRoom room(40, 9, 7);
    Random random(11);
    auto caster = make_ray_caster(room.grid);
    GoalSelection kept(team, room.grid.lattice(), room.bounds());
    for (int step = 0; step < 6; ++step) {
      const VoxelGrid before = room.grid;
      for (int i = 0; i < 3; ++i) room.box(random, 3, 3, static_cast<Occupancy>(random.below(3)));
      const int x = 8 + random.below(20), y = 8 + random.below(20);
      room.clear(x, y, 2);
      room.clear(y, x, 5);
      // A whole block at once, too.
      if (step == 3) room.grid.fill({room.key(0, 0, 0), 3}, Occupancy::kFree);
      caster->update(room.grid);
      const std::array poses = {room.pose(x, y, 2), room.pose(y, x, 5)};
      const auto frontiers = room.frontiers();
      GoalSelection fresh(team, room.grid.lattice(), room.bounds());
      const auto changed = test::changed_keys(before, room.grid);
      expect_same(kept.select(*caster, {room.grid, changed}, frontiers, poses),
                  fresh.select(*caster, {room.grid}, frontiers, poses), false);
    }
  }
}

TEST(GoalSelection, RobotsThatWereOutsideTheKeyRangeChooseAsIfTheyHadNotBeen) {
  for (const auto& team : teams()) {
    GoalRoom room(40, 9, 7);
    room.clear(12, 20, 2);
    room.clear(20, 12, 5);
    const auto caster = make_grid_ray_caster(room.grid);
    const auto frontiers = room.frontiers();
    const std::array poses = {room.pose(12, 20, 2), room.pose(20, 12, 5)};
    std::array lost = poses;
    for (Pose& pose : lost) pose.position.x() = 1e6;
    GoalSelection kept(team, room.grid.lattice(), room.bounds());
    const TeamGoals before = kept.select(*caster, {room.grid}, frontiers, poses);
    EXPECT_TRUE(before.goals[0].pose || before.goals[1].pose);
    EXPECT_EQ(kept.select(*caster, {room.grid}, frontiers, lost).unassigned, frontiers.size());
    expect_same(kept.select(*caster, {room.grid}, frontiers, poses), before, false);
  }
}

TEST(GoalSelection, WrongCallsAreRefusedByName) {
  const GoalRoom room(12, 6);
  const auto caster = make_grid_ray_caster(room.grid);
  const auto make = [&](const TeamMember& member) {
    GoalSelection selection({member}, room.grid.lattice(), room.bounds());
  };
  const auto message = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TeamMember member = ground_robot();
  member.options.lambda = nan;
  EXPECT_NE(message([&] { make(member); }).find("'ugv': goal selection: lambda is nan"), std::string::npos);
  member = ground_robot();
  member.options.refined = -1;
  EXPECT_NE(message([&] { make(member); }).find("refined is -1"), std::string::npos);
  member = aerial_robot();
  member.options.rendering.azimuth_bins = 3;
  EXPECT_NE(message([&] { make(member); }).find("'uav'"), std::string::npos);
  member = aerial_robot();
  member.robot.view.max_range = -2;
  EXPECT_NE(message([&] { make(member); }).find("max_range"), std::string::npos);

  GoalSelection selection({ground_robot()}, room.grid.lattice(), room.bounds());
  Pose pose = room.pose(5, 5, 2);
  pose.position.x() = nan;
  const auto ask = [&](std::span<const Pose> poses) {
    static_cast<void>(selection.select(*caster, {room.grid}, {}, poses));
  };
  EXPECT_NE(message([&] { ask({&pose, 1}); }).find("'ugv' is not finite"), std::string::npos);
  EXPECT_NE(message([&] { ask({}); }).find("0 poses for 1 robots"), std::string::npos);
  const VoxelGrid other(0.2);
  pose = room.pose(5, 5, 2);
  EXPECT_NE(message([&] {
              static_cast<void>(selection.select(*caster, {other}, {}, {&pose, 1}));
            }).find("0.2"),
            std::string::npos);
}

}  // namespace
}  // namespace frontlux::test
