// The cells that are rendered: some that stand for all, and only those that may be the goal, against all.

#include "goal/viewpoint_candidates.hpp"

#include "planner/goal/goal_room.hpp"

namespace frontlux::test {
namespace {

using namespace planner;

constexpr int kAllCells = 1 << 30;

TEST(SpacedCells, AreTheFirstOfEachCubeAndAllAroundTheRobot) {
  Random random(3);
  for (int round = 0; round < 60; ++round) {
    const int x = random.one_in(2) ? 0 : 32700, stride = random.below(5), surroundings = random.below(6);
    std::vector<VoxelKey> cells;
    for (const VoxelKey& key : keys_of({make_key(x, 500, 65520), make_key(x + 15, 515, 65535)}))
      if (random.one_in(4)) cells.push_back(key);
    std::ranges::sort(cells);
    const VoxelKey robot = random.pick(cells);
    std::set<std::array<int, 3>> cubes;
    std::vector<VoxelKey> expected;
    for (const VoxelKey& cell : cells) {
      const bool near = grown({robot, robot}, surroundings).contains(cell);
      const int edge = std::max(stride, 1);
      if (cubes.insert({cell.x / edge, cell.y / edge, cell.z / edge}).second || near)
        expected.push_back(cell);
    }
    EXPECT_EQ(planner::detail::spaced_cells(cells, stride, robot, surroundings), expected);
  }
}

struct Case {
  double lambda, advance;
  bool camera;
  double min_gain = 0.0;
};

TeamMember robot_in_space(const Case& example) {
  TeamMember member{uav(), goal_options(uav())};
  member.robot.travel.min_height = 0.0;
  if (!example.camera) member.robot.view = ugv().view;
  member.robot.view.max_range = 3.0;
  member.options.lambda = example.lambda;
  member.options.advance = example.advance;
  member.options.min_gain = example.min_gain;
  member.options.rendering.samples = 3;
  return member;
}

struct Chosen {
  Goal goal;
  std::vector<RenderedCell> cells;
};

Chosen choose(const GoalRoom& room, const RayCaster& caster, const TeamMember& member) {
  GoalSelection selection({member}, room.grid.lattice(), room.bounds());
  const Pose pose = room.pose(4, 4, 3);
  Chosen chosen;
  chosen.goal = selection.select(caster, {room.grid}, room.frontiers(), {&pose, 1}).goals[0];
  chosen.cells = selection.rendered_cells(0);
  return chosen;
}

std::set<VoxelKey> keys_of(const std::vector<RenderedCell>& cells) {
  std::set<VoxelKey> keys;
  for (const RenderedCell& cell : cells) keys.insert(cell.cell);
  return keys;
}

class PossibleGoals : public testing::TestWithParam<Case> {};

TEST_P(PossibleGoals, WhatIsLeftOutIsWorseThanTheGoal) {
  std::size_t all = 0, possible = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    GoalRoom room(50, 7, seed);
    room.clear(4, 4, 3);
    const auto caster = make_grid_ray_caster(room.grid);
    TeamMember member = robot_in_space(GetParam());
    ASSERT_TRUE(member.options.prune);
    member.options.refined = kAllCells;
    const Chosen pruned = choose(room, *caster, member);
    // The judge counts every target of every cell and leaves none out.
    member.options.prune = false;
    member.options.rendering.samples = ViewQualityOptions::kAll;
    const Chosen judge = choose(room, *caster, member);
    ASSERT_EQ(pruned.goal.pose.has_value(), judge.goal.pose.has_value());
    if (!judge.goal.pose) continue;
    EXPECT_EQ(pruned.goal.cell, judge.goal.cell);
    EXPECT_EQ(pruned.goal.pose->yaw, judge.goal.pose->yaw);
    EXPECT_EQ(pruned.goal.gain, judge.goal.gain);
    EXPECT_EQ(pruned.goal.quality, judge.goal.quality);
    const std::set<VoxelKey> rendered = keys_of(pruned.cells), cells = keys_of(judge.cells);
    EXPECT_TRUE(std::includes(cells.begin(), cells.end(), rendered.begin(), rendered.end()));
    for (const RenderedCell& cell : judge.cells) {
      ASSERT_EQ(cell.standard_error, 0.0);
      if (rendered.contains(cell.cell) || cell.distance < 0.6) continue;
      const bool enough = cell.gain >= GetParam().min_gain,
                 goal_is_enough = judge.goal.gain >= GetParam().min_gain;
      EXPECT_TRUE(goal_is_enough || !enough);
      if (enough == goal_is_enough) {
        EXPECT_LT(cell.quality, judge.goal.quality);
      }
    }
    all += judge.cells.size();
    possible += pruned.cells.size();
  }
  EXPECT_GT(possible, 0U);
  if (GetParam().lambda > 0.0) {
    // Where hardly a cell has enough, any of many may be the one that has.
    const bool steep = GetParam().lambda >= 0.3 && GetParam().min_gain <= 10.0;
    EXPECT_LT(possible, steep ? all / 2 : all);
  }
}

TEST_P(PossibleGoals, AFewCountedCellsLeadToNoWorseAGoal) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const int refined : {1, 4, 64}) {
      SCOPED_TRACE(seed);
      GoalRoom room(50, 7, seed);
      room.clear(4, 4, 3);
      const auto caster = make_ray_caster(room.grid);
      TeamMember member = robot_in_space(GetParam());
      member.options.refined = refined;
      const Goal pruned = choose(room, *caster, member).goal;
      member.options.prune = false;
      const Goal unpruned = choose(room, *caster, member).goal;
      ASSERT_EQ(pruned.pose.has_value(), unpruned.pose.has_value());
      EXPECT_EQ(pruned.standard_error, 0.0);
      const bool enough = pruned.gain >= member.options.min_gain,
                 unpruned_is_enough = unpruned.gain >= member.options.min_gain;
      EXPECT_TRUE(enough || !unpruned_is_enough);
      if (enough == unpruned_is_enough) {
        EXPECT_GE(pruned.quality, unpruned.quality);
      }
    }
}

// With lambda 0 every cell that sees as many is as good: there are many ties, and the smallest key wins.
INSTANTIATE_TEST_SUITE_P(Qualities, PossibleGoals,
                         testing::Values(Case{0.0, 0.0, true}, Case{0.0, 0.0, false}, Case{0.1386, 4.0, true},
                                         Case{0.1386, 0.0, false}, Case{1.0, 4.0, true},
                                         Case{0.5, 2.0, false}, Case{1.0, 4.0, true, 10.0},
                                         Case{0.5, 0.0, false, 20.0}, Case{1.0, 4.0, true, 1e6}));

// The nearest cells see little; what they are to be compared with is that which `min_gain` asks for.
TEST(PossibleGoals, TheBestOfThoseWithEnoughIsTheGoalHoweverFar) {
  int farther = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    GoalRoom room(50, 7, seed);
    room.clear(4, 4, 3);
    const auto caster = make_grid_ray_caster(room.grid);
    TeamMember member = robot_in_space({2.0, 0.0, true});
    member.options.prune = false;
    member.options.rendering.samples = ViewQualityOptions::kAll;
    const Chosen anything = choose(room, *caster, member);
    ASSERT_TRUE(anything.goal.pose);
    // As it will truly be seen: a window of azimuths holds a little more than any one view.
    std::vector<RenderedCell> cells;
    const auto frontiers = room.frontiers();
    for (RenderedCell cell : anything.cells) {
      if (cell.distance < 0.6) continue;
      const double quality_of_one = cell.quality / cell.gain;
      cell.gain = static_cast<double>(std::ranges::count_if(frontiers, [&](const VoxelKey& target) {
        return member.robot.view.contains(offset_between(cell.cell, target, 0.3), cell.yaw) &&
               is_visible(*caster, {cell.cell, target}, UnknownPolicy::kBlock);
      }));
      cell.quality = cell.gain * quality_of_one;
      if (cell.gain > 0.0) cells.push_back(cell);
    }
    double most = 0.0;
    for (const RenderedCell& cell : cells) most = std::max(most, cell.gain);
    for (const double min_gain : {most / 2, most, most + 1}) {
      member.options.min_gain = min_gain;
      const Goal goal = choose(room, *caster, member).goal;
      ASSERT_TRUE(goal.pose);
      double best = 0.0;
      for (const RenderedCell& cell : cells)
        if (cell.gain >= min_gain || min_gain > most) best = std::max(best, cell.quality);
      EXPECT_NEAR(goal.quality, best, 1e-12 * best);
      if (goal.distance > anything.goal.distance) ++farther;
    }
  }
  EXPECT_GT(farther, 0);
}

TEST(PossibleGoals, WithoutCountedCellsNothingIsLeftOut) {
  GoalRoom room(50, 7, 2);
  room.clear(4, 4, 3);
  const auto caster = make_grid_ray_caster(room.grid);
  TeamMember member = robot_in_space({1.0, 4.0, true});
  member.options.refined = 0;
  const Chosen pruned = choose(room, *caster, member);
  member.options.prune = false;
  EXPECT_EQ(pruned.cells.size(), choose(room, *caster, member).cells.size());
}

}  // namespace
}  // namespace frontlux::test
