// Goals against plain formulas: every cell and every frontier asked one by one, distances by a flood fill.

#include "planner/goal/goal_truth.hpp"
#include "planner/recording/random_recording.hpp"
#include "support/complaint.hpp"
#include "support/voxel_keys.hpp"

#include <tbb/task_arena.h>

namespace frontlux::test {
namespace {

TEST(GoalSelection, GroundRobotTakesTheCellWithTheBestViewQuality) {
  for (const DistanceMeasure distance : {DistanceMeasure::kPath, DistanceMeasure::kStraight})
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      GoalRoom room(26, 6, seed);
      room.clear(13, 13, 2);
      TeamMember member = ground_robot();
      member.options.distance = distance;
      member.options.rendering.samples = ViewQualityOptions::kAll;
      const Decision decision(room, member, room.key(13, 13, 2), room.frontiers());
      const auto cells = decision.cells();
      ASSERT_GT(cells.size(), 40U);
      const auto assigned = decision.assigned();
      EXPECT_EQ(decision.goal().assigned, assigned.size());
      EXPECT_EQ(decision.team.unassigned, decision.frontiers.size() - assigned.size());
      const auto steps = naive_steps(cells, decision.start);
      ASSERT_EQ(steps.size(), cells.size());
      std::optional<Found> best;
      for (const VoxelKey& cell : cells) {
        const double d = distance == DistanceMeasure::kPath
                             ? steps.at(cell) * kResolution
                             : offset_between(decision.start, cell, kResolution).norm();
        if (d < 0.59) continue;
        const auto gain = static_cast<double>(decision.seen_from(cell, assigned).size());
        const double quality = worth(gain, d);
        // Sums of equal cells in another order differ in the last digits.
        if (gain > 0 && (!best || quality > best->quality * (1 + 1e-9))) best = Found{cell, gain, quality, 0};
      }
      expect_goal(decision.goal(), best);
      EXPECT_EQ(decision.goal().state, GoalState::kAssigned);
      const auto rendered = decision.selection.rendered_cells(0);
      ASSERT_EQ(rendered.size(), cells.size());
      for (std::size_t i = 0; i < rendered.size(); i += 17)
        EXPECT_EQ(rendered[i].gain,
                  static_cast<double>(decision.seen_from(rendered[i].cell, assigned).size()));
    }
}

TEST(GoalSelection, DrawnTargetsLeadToACellWhoseGainIsCounted) {
  GoalRoom room(26, 6, 3);
  room.clear(13, 13, 2);
  for (const int refined : {1, 5, 200}) {
    TeamMember member = ground_robot();
    member.options.rendering.samples = 2;
    member.options.refined = refined;
    const Decision decision(room, member, room.key(13, 13, 2), room.frontiers());
    const Goal& goal = decision.goal();
    ASSERT_TRUE(goal.pose);
    const auto targets = decision.selection.targets(0);
    EXPECT_EQ(goal.gain,
              static_cast<double>(decision.seen_from(goal.cell, {targets.begin(), targets.end()}).size()));
    EXPECT_EQ(goal.standard_error, 0.0);
  }
}

TEST(GoalSelection, PaperModeCountsHitsAmongTheDrawn) {
  GoalRoom room(26, 6, 4);
  room.clear(13, 13, 2);
  TeamMember member = ground_robot();
  member.options = goal_options(member.robot, Method::kPaper);
  member.options.rendering.samples = 5;
  const Decision decision(room, member, room.key(13, 13, 2), room.frontiers());
  ASSERT_TRUE(decision.goal().pose);
  double best = 0;
  for (const auto& cell : decision.selection.rendered_cells(0)) {
    EXPECT_LE(cell.gain, 5.0);
    EXPECT_EQ(cell.gain, cell.hits);
    const double d = offset_between(decision.start, cell.cell, kResolution).norm();
    EXPECT_NEAR(cell.quality, cell.hits * std::exp(-0.1386 * d), 1e-5);
    if (d > 0.59) best = std::max(best, cell.quality);
  }
  EXPECT_EQ(decision.goal().quality, best);
}

TEST(GoalSelection, AerialRobotTakesTheCellWithTheBestWindow) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    GoalRoom room(15, 9, seed);
    room.clear(7, 7, 4);
    TeamMember member = aerial_robot();
    member.options.rendering.samples = 3;
    member.options.refined = kAllCells;
    member.options.prune = false;
    member.options.surroundings = 1;
    const Decision decision(room, member, room.key(7, 7, 4), room.frontiers());
    const auto cells = decision.cells();
    ASSERT_GT(cells.size(), 40U);
    const auto assigned = decision.assigned();
    EXPECT_EQ(decision.goal().assigned, assigned.size());
    const auto steps = naive_steps(cells, decision.start);
    std::set<std::array<int, 3>> cubes;
    std::optional<Found> best;
    std::size_t viewpoints = 0;
    for (const VoxelKey& cell : cells) {
      const bool first = cubes.insert({cell.x / 2, cell.y / 2, cell.z / 2}).second;
      const Eigen::Vector3d away = offset_between(decision.start, cell, 1.0).cwiseAbs();
      if (!first && away.maxCoeff() > 2) continue;
      ++viewpoints;
      if (steps.at(cell) < 2) continue;
      const auto seen = decision.seen_from(cell, assigned);
      const Found found_window = best_yaw(cell, seen, member.robot.view.horizontal, nullptr);
      Found found = in_true_view(found_window, seen, member.robot.view);
      found.quality = worth(found.gain, steps.at(cell) * kResolution);
      if (found.gain > 0 && (!best || found.quality > best->quality * (1 + 1e-9))) best = found;
    }
    EXPECT_EQ(decision.selection.rendered_cells(0).size(), viewpoints);
    expect_goal(decision.goal(), best);
    ASSERT_TRUE(best);
    EXPECT_NEAR(decision.goal().pose->yaw, best->yaw, 1e-9);
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
  for (std::size_t r = 0; r < a.goals.size(); ++r) EXPECT_EQ(listed(a.goals[r]), listed(b.goals[r]));
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
        return tbb::task_arena(threads).execute([&] {
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
      for (int i = 0; i < 3; ++i) room.box(random, 3, 3, random.state());
      const int x = 8 + random.below(20), y = 8 + random.below(20);
      room.clear(x, y, 2);
      room.clear(y, x, 5);
      // A whole block at once, too.
      if (step == 3) room.grid.fill({room.key(0, 0, 0), 3}, Occupancy::kFree);
      caster->update(room.grid);
      const std::array poses = {room.pose(x, y, 2), room.pose(y, x, 5)};
      const auto frontiers = room.frontiers();
      GoalSelection fresh(team, room.grid.lattice(), room.bounds());
      const auto changed = changed_keys(before, room.grid);
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
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [&](TeamMember member, const auto& spoil, const std::string& part) {
    spoil(member);
    expect_complaint([&] { GoalSelection({member}, room.grid.lattice(), room.bounds()); }, {part});
  };
  refuses(
      ground_robot(), [&](auto& m) { m.options.lambda = nan; }, "'ugv': goal selection: lambda is nan");
  refuses(
      ground_robot(), [](auto& m) { m.options.refined = -1; }, "refined is -1");
  refuses(
      aerial_robot(), [](auto& m) { m.options.rendering.azimuth_bins = 3; }, "'uav'");
  refuses(
      aerial_robot(), [](auto& m) { m.robot.view.max_range = -2; }, "max_range");

  // A view has room for a bin of azimuth, however narrow it is.
  for (const double degrees : {0.1, 1.0, 8.0, 10.0, 90.0}) {
    TeamMember narrow = aerial_robot();
    narrow.robot.view.horizontal = degrees * std::numbers::pi / 180;
    narrow.options = goal_options(narrow.robot);
    const GoalSelection accepts({narrow}, room.grid.lattice(), room.bounds());
    EXPECT_EQ(narrow.options.rendering.azimuth_bins, degrees < 10 ? std::lround(360 / degrees) : 36);
  }

  GoalSelection selection({ground_robot()}, room.grid.lattice(), room.bounds());
  const auto refuses_to_ask = [&](const VoxelGrid& grid, std::span<const Pose> poses,
                                  const std::string& part) {
    expect_complaint([&] { static_cast<void>(selection.select(*caster, {grid}, {}, poses)); }, {part});
  };
  const Pose pose = room.pose(5, 5, 2), lost{{nan, pose.position.y(), pose.position.z()}, 0.0};
  refuses_to_ask(room.grid, {&lost, 1}, "'ugv' is not finite");
  refuses_to_ask(room.grid, {}, "0 poses for 1 robots");
  refuses_to_ask(VoxelGrid(0.2), {&pose, 1}, "0.2");
}

}  // namespace
}  // namespace frontlux::test
