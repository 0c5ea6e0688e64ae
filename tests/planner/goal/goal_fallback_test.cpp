// What a team does when a robot finds no goal: each case on a map made for it.

#include "planner/goal/goal_room.hpp"
#include "support/complaint.hpp"

namespace frontlux::test {
namespace {

using namespace planner;

class GoalFallback : public testing::TestWithParam<Method> {
 protected:
  [[nodiscard]] std::vector<TeamMember> team() const {
    const Robot ground = ugv();
    Robot aerial = uav(GetParam());
    aerial.travel.min_height = 0.6;
    return {{ground, goal_options(ground, GetParam())}, {aerial, goal_options(aerial, GetParam())}};
  }

  [[nodiscard]] TeamGoals select(const GoalRoom& room, const std::vector<VoxelKey>& frontiers,
                                 const std::array<Pose, 2>& poses) const {
    const auto caster = make_grid_ray_caster(room.grid);
    GoalSelection selection(team(), room.grid.lattice(), room.bounds());
    return selection.select(*caster, {room.grid}, frontiers, poses);
  }

  static void expect_none(const Goal& goal, GoalState state) {
    EXPECT_FALSE(goal.pose);
    EXPECT_EQ(goal.state, state) << goal.reason;
    expect_parts(goal.reason, {"no goal"});
    EXPECT_EQ(goal.gain, 0.0);
    EXPECT_EQ(goal.quality, 0.0);
  }
};

TEST_P(GoalFallback, WhatOneCannotSeeThroughUnknownSpaceIsReleasedToTheOther) {
  GoalRoom room(40, 16);
  // A sheet of unknown voxels: Alg. 2 looks through it, rendering does not.
  fill(room.grid, {room.key(0, 0, 6), room.key(39, 39, 6)}, Occupancy::kUnknown);
  const VoxelKey frontier = room.unknown(20, 36, 8);
  const TeamGoals result = select(room, {frontier}, {room.pose(20, 20, 2), room.pose(20, 20, 10)});
  const Goal &ground = result.goals[0], &aerial = result.goals[1];
  expect_none(ground, GoalState::kNothingVisible);
  EXPECT_EQ(ground.assigned, 1U);
  EXPECT_EQ(ground.released, 1U);
  expect_parts(ground.reason, {"releases 1 frontier, other robots take 1"});
  EXPECT_EQ(aerial.assigned, 0U);
  EXPECT_EQ(aerial.received, 1U);
  EXPECT_EQ(aerial.state, GoalState::kReceived);
  ASSERT_TRUE(aerial.pose);
  EXPECT_EQ(aerial.gain, 1.0);
  EXPECT_TRUE(uav().view.contains(room.pose(20, 36, 8).position - aerial.pose->position, aerial.pose->yaw));
  EXPECT_EQ(result.unassigned, 0U);
}

TEST_P(GoalFallback, WhatIsReleasedToOneThatDoesNotChooseLeavesItsGoalAsItIs) {
  GoalRoom room(40, 16);
  fill(room.grid, {room.key(0, 0, 6), room.key(39, 39, 6)}, Occupancy::kUnknown);
  const std::vector<VoxelKey> frontiers = {room.unknown(20, 36, 8)};
  const std::array poses{room.pose(20, 20, 2), room.pose(20, 20, 10)};
  const auto caster = make_grid_ray_caster(room.grid);
  GoalSelection selection(team(), room.grid.lattice(), room.bounds());
  const Goal before = selection.select(*caster, {room.grid}, frontiers, poses).goals[1];
  EXPECT_EQ(before.received, 1U);
  for (int times = 1; times <= 3; ++times) {
    const TeamGoals result = selection.select(*caster, {room.grid}, frontiers, poses, 0);
    EXPECT_EQ(result.goals[0].released, 1U);
    EXPECT_EQ(result.goals[1].received, 1U);
    EXPECT_EQ(result.goals[1].reason, before.reason);
  }
}

TEST_P(GoalFallback, WhatNoRobotSeesIsReleasedByBothAndStaysUnassigned) {
  GoalRoom room(40, 16);
  fill(room.grid, {room.key(16, 27, 3), room.key(24, 35, 11)}, Occupancy::kUnknown);
  const std::vector<VoxelKey> frontiers = keys_of({room.key(19, 31, 6), room.key(21, 31, 6)});
  const TeamGoals result = select(room, frontiers, {room.pose(20, 20, 2), room.pose(20, 10, 6)});
  expect_none(result.goals[0], GoalState::kNothingVisible);
  expect_none(result.goals[1], GoalState::kNothingVisible);
  EXPECT_EQ(result.goals[0].released, 3U);
  EXPECT_EQ(result.goals[1].received, 3U);
  EXPECT_EQ(result.goals[1].released, 3U);
  EXPECT_EQ(result.unassigned, 3U);
}

TEST_P(GoalFallback, WhatALostRobotWasToSeeIsForTheOthers) {
  GoalRoom room(40, 16);
  const std::vector<VoxelKey> frontiers = {room.unknown(20, 36, 8)};
  const std::array poses{room.pose(20, 20, 10), room.pose(20, 10, 10)};
  const auto caster = make_grid_ray_caster(room.grid);
  GoalSelection selection({team()[1], team()[1]}, room.grid.lattice(), room.bounds());
  EXPECT_EQ(selection.select(*caster, {room.grid}, frontiers, poses).goals[0].assigned, 1U);
  selection.lose(0);
  const TeamGoals result = selection.select(*caster, {room.grid}, frontiers, poses);
  EXPECT_EQ(result.goals[0].assigned, 0U);
  EXPECT_EQ(result.goals[1].assigned, 1U);
}

TEST_P(GoalFallback, WithNothingOfItsOwnTheAerialRobotTakesWhatTheOthersGoalDoesNotSee) {
  GoalRoom room(60, 8);
  std::vector<VoxelKey> frontiers;
  for (int i = 0; i < 4; ++i) frontiers.push_back(room.unknown(3 + i, 3, 2));
  for (int i = 0; i < 3; ++i) frontiers.push_back(room.unknown(54 + i, 56, 2));
  const TeamGoals result = select(room, frontiers, {room.pose(12, 12, 2), room.pose(30, 30, 4)});
  const Goal &ground = result.goals[0], &aerial = result.goals[1];
  EXPECT_EQ(ground.state, GoalState::kAssigned);
  EXPECT_EQ(ground.assigned, 7U);
  ASSERT_TRUE(ground.pose);
  EXPECT_EQ(ground.gain, 4.0);
  EXPECT_EQ(aerial.assigned, 0U);
  EXPECT_EQ(aerial.state, GoalState::kUncovered) << aerial.reason;
  EXPECT_EQ(aerial.uncovered, 3U);
  ASSERT_TRUE(aerial.pose);
  EXPECT_EQ(aerial.gain, 3.0);
  EXPECT_GT(aerial.pose->position.x(), 9.0);
}

TEST_P(GoalFallback, WithNothingLeftTheAerialRobotStays) {
  GoalRoom room(30, 8);
  const VoxelKey frontier = room.unknown(3, 3, 2);
  const TeamGoals result = select(room, {frontier}, {room.pose(12, 12, 2), room.pose(20, 20, 4)});
  EXPECT_EQ(result.goals[0].state, GoalState::kAssigned);
  expect_none(result.goals[1], GoalState::kNothingAssigned);
  expect_parts(result.goals[1].reason, {"it sees no frontiers that the goals of other robots"});
}

TEST_P(GoalFallback, BehindWallsNothingIsAssigned) {
  GoalRoom room(30, 8);
  fill(room.grid, {room.key(3, 3, 1), room.key(5, 5, 3)}, Occupancy::kOccupied);
  const VoxelKey frontier = room.unknown(4, 4, 2);
  const TeamGoals result = select(room, {frontier}, {room.pose(12, 12, 2), room.pose(20, 20, 4)});
  expect_none(result.goals[0], GoalState::kNothingAssigned);
  expect_none(result.goals[1], GoalState::kNothingAssigned);
  EXPECT_EQ(result.unassigned, 1U);
}

TEST_P(GoalFallback, ARobotInABadPlaceHasNoGoalAndTheOtherTakesAll) {
  for (const Occupancy state : {Occupancy::kUnknown, Occupancy::kOccupied}) {
    GoalRoom room(30, 8);
    const VoxelKey frontier = room.unknown(3, 3, 4);
    room.grid.set(room.key(12, 12, 2), state);
    const TeamGoals result = select(room, {frontier}, {room.pose(12, 12, 2), room.pose(20, 20, 4)});
    expect_none(result.goals[0], GoalState::kNoCorridor);
    expect_parts(result.goals[0].reason, {state == Occupancy::kUnknown ? "unknown voxel" : "occupied voxel"});
    EXPECT_EQ(result.goals[1].state, GoalState::kAssigned);
    EXPECT_EQ(result.goals[1].assigned, 1U);
  }
  GoalRoom room(30, 8);
  const VoxelKey frontier = room.unknown(3, 3, 4);
  Pose lost = room.pose(12, 12, 2);
  lost.position.x() = 1e9;
  const TeamGoals result = select(room, {frontier}, {lost, room.pose(20, 20, 4)});
  expect_none(result.goals[0], GoalState::kNoCorridor);
  expect_parts(result.goals[0].reason, {"outside the key range"});
  EXPECT_TRUE(result.goals[1].pose);
  // In a gap that is too narrow for its box.
  room.grid.set(room.key(13, 12, 1), Occupancy::kOccupied);
  const TeamGoals narrow = select(room, {frontier}, {room.pose(12, 12, 2), room.pose(13, 12, 2)});
  expect_none(narrow.goals[0], GoalState::kNoCorridor);
  expect_none(narrow.goals[1], GoalState::kNoCorridor);
  EXPECT_EQ(narrow.unassigned, 1U);
}

TEST_P(GoalFallback, WithoutUnknownSpaceThereIsNothingToDo) {
  const GoalRoom room(20, 8);
  const auto frontiers = room.frontiers();
  ASSERT_TRUE(frontiers.empty());
  const TeamGoals result = select(room, frontiers, {room.pose(10, 10, 2), room.pose(10, 10, 4)});
  expect_none(result.goals[0], GoalState::kNoFrontiers);
  expect_none(result.goals[1], GoalState::kNoFrontiers);
  EXPECT_EQ(result.rays, 0U);
}

TEST_P(GoalFallback, ATeamWithoutRobotsHasNoGoals) {
  const GoalRoom room(8, 8);
  const auto caster = make_grid_ray_caster(room.grid);
  GoalSelection selection({}, room.grid.lattice(), room.bounds());
  const std::vector<VoxelKey> frontiers = {room.key(1, 1, 1)};
  const TeamGoals result = selection.select(*caster, {room.grid}, frontiers, {});
  EXPECT_TRUE(result.goals.empty());
  EXPECT_EQ(result.unassigned, 1U);
}

INSTANTIATE_TEST_SUITE_P(Methods, GoalFallback, testing::Values(Method::kDefault, Method::kPaper),
                         [](const auto& method) {
                           return method.param == Method::kPaper ? "Paper" : "Default";
                         });

}  // namespace
}  // namespace frontlux::test
