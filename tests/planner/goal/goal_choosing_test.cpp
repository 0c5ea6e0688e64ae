// One robot of a team chooses; the others keep their goals.

#include "planner/goal/goal_truth.hpp"
#include "planner/recording/random_recording.hpp"

namespace frontlux::test {
namespace {

// Two robots in the same room, and what is known of it grows.
struct GrowingRoom {
  GoalRoom room{40, 9, 5};
  std::vector<TeamMember> team = {ground_robot(), aerial_robot()};
  std::array<Pose, 2> poses;
  GoalSelection selection{team, room.grid.lattice(), room.bounds()};

  GrowingRoom() {
    room.clear(12, 20, 2);
    room.clear(28, 12, 5);
    poses = {room.pose(12, 20, 2), room.pose(28, 12, 5)};
  }
  TeamGoals select(GoalSelection& by, const MapChange& change, const std::vector<VoxelKey>& frontiers,
                   std::optional<std::size_t> choosing) {
    return by.select(*make_grid_ray_caster(change.grid), change, frontiers, poses, choosing);
  }
  TeamGoals first(GoalSelection& by) { return select(by, {room.grid}, room.frontiers(), std::nullopt); }

  // Frees what hides the frontiers of some goals, and moves both robots by a voxel.
  VoxelGrid grow() {
    VoxelGrid grid = room.grid;
    Random random(3);
    for (int i = 0; i < 12; ++i) {
      const VoxelKey corner = random.key_in({GoalRoom::key(2, 2, 0), GoalRoom::key(36, 36, 5)});
      fill(grid, {corner, make_key(corner.x + 2, corner.y + 2, corner.z + 2)},
           i < 8 ? Occupancy::kFree : Occupancy::kUnknown);
    }
    std::swap(grid, room.grid);
    room.clear(13, 20, 2);
    room.clear(28, 13, 5);
    poses = {room.pose(13, 20, 2), room.pose(28, 13, 5)};
    return grid;
  }
};

bool same_goal(const Goal& a, const Goal& b) {
  return a.pose.has_value() == b.pose.has_value() && a.cell == b.cell && a.gain == b.gain &&
         a.quality == b.quality && a.distance == b.distance && a.state == b.state &&
         (!a.pose || (a.pose->position == b.pose->position && a.pose->yaw == b.pose->yaw));
}

TEST(ChoosingRobot, ChoosesAsInATeamThatAllChooseAndTheOthersKeepTheirGoals) {
  for (const std::size_t choosing : {0U, 1U}) {
    SCOPED_TRACE(choosing);
    GrowingRoom one, all;
    const TeamGoals before = one.first(one.selection);
    static_cast<void>(all.first(all.selection));
    ASSERT_TRUE(before.goals[0].pose && before.goals[1].pose);
    const std::size_t other = 1 - choosing;
    const auto keys = one.selection.targets(other);
    const std::vector<VoxelKey> targets(keys.begin(), keys.end());

    const VoxelGrid old = one.grow();
    static_cast<void>(all.grow());
    const auto changed = changed_keys(old, one.room.grid);
    const auto frontiers = one.room.frontiers();
    const TeamGoals now = one.select(one.selection, {one.room.grid, changed}, frontiers, choosing),
                    all_now = all.select(all.selection, {all.room.grid, changed}, frontiers, std::nullopt);
    ASSERT_EQ(all_now.goals[0].released + all_now.goals[1].released, 0U)
        << "they do not depend on each other";
    EXPECT_TRUE(same_goal(now.goals[choosing], all_now.goals[choosing]));
    EXPECT_FALSE(same_goal(now.goals[choosing], before.goals[choosing]));
    EXPECT_TRUE(same_goal(now.goals[other], before.goals[other]));
    EXPECT_FALSE(same_goal(all_now.goals[other], before.goals[other])) << "it would have had another";
    EXPECT_TRUE(std::ranges::equal(one.selection.targets(other), targets));
    EXPECT_FALSE(one.selection.rendered_cells(choosing).empty());
    EXPECT_TRUE(one.selection.rendered_cells(other).empty()) << "nothing was rendered for it";
    // The frontiers are divided among both all the same.
    EXPECT_EQ(now.unassigned, all_now.unassigned);
    EXPECT_EQ(now.goals[choosing].assigned, all_now.goals[choosing].assigned);
    // Corridors are those of where the robots are.
    for (std::size_t r = 0; r < 2; ++r)
      EXPECT_TRUE(std::ranges::equal(one.selection.corridor(r).cells(), all.selection.corridor(r).cells()));
  }
}

TEST(ChoosingRobot, IsNobody) {
  GrowingRoom scene, all;
  static_cast<void>(scene.first(scene.selection));
  const auto cells = [](const GoalSelection& selection, std::size_t robot) {
    const auto span = selection.corridor(robot).cells();
    return std::vector<VoxelKey>(span.begin(), span.end());
  };
  const auto before = cells(scene.selection, 1);
  const VoxelGrid old = scene.grow();
  static_cast<void>(all.grow());
  scene.selection.update_corridor({scene.room.grid, changed_keys(old, scene.room.grid)}, 0, scene.poses[0]);
  EXPECT_TRUE(scene.selection.rendered_cells(0).empty()) << "they may be none of its cells any more";
  GoalSelection fresh(all.team, all.room.grid.lattice(), all.room.bounds());
  const TeamGoals wanted = all.first(fresh);
  EXPECT_EQ(cells(scene.selection, 0), cells(fresh, 0));
  EXPECT_EQ(cells(scene.selection, 1), before) << "nothing but one robot's corridor";
  EXPECT_NE(cells(fresh, 1), before);
  // Who chooses next knows what has changed meanwhile.
  const TeamGoals then =
      scene.select(scene.selection, {scene.room.grid}, scene.room.frontiers(), std::nullopt);
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_TRUE(same_goal(then.goals[r], wanted.goals[r]));
    EXPECT_EQ(cells(scene.selection, r), cells(fresh, r));
  }
}

// Without frontiers there is nothing to go for, now and when another robot chooses.
TEST(ChoosingRobot, LosesItsGoalWithTheLastFrontier) {
  GrowingRoom scene;
  ASSERT_TRUE(scene.first(scene.selection).goals[0].pose);
  const TeamGoals none = scene.select(scene.selection, {scene.room.grid}, {}, 0);
  EXPECT_FALSE(none.goals[0].pose);
  EXPECT_EQ(none.goals[0].state, GoalState::kNoFrontiers);
  EXPECT_TRUE(none.goals[1].pose);
  EXPECT_FALSE(scene.select(scene.selection, {scene.room.grid}, scene.room.frontiers(), 1).goals[0].pose);
}

TEST(ChoosingRobot, KeepsOutOfPlacesOfOthers) {
  GrowingRoom scene;
  const Goal free = scene.first(scene.selection).goals[0];
  ASSERT_TRUE(free.pose);
  const auto around = [](const VoxelKey& key) {
    return KeyBox{make_key(key.x - 2, key.y - 2, key.z - 2), make_key(key.x + 2, key.y + 2, key.z + 2)};
  };
  scene.selection.keep_out_of(0, {around(free.cell)});
  const Goal kept_out = scene.select(scene.selection, {scene.room.grid}, scene.room.frontiers(), 0).goals[0];
  ASSERT_TRUE(kept_out.pose);
  EXPECT_FALSE(around(free.cell).contains(kept_out.cell));
  scene.selection.keep_out_of(0, {});
  EXPECT_TRUE(
      same_goal(scene.select(scene.selection, {scene.room.grid}, scene.room.frontiers(), 0).goals[0], free));
}

}  // namespace
}  // namespace frontlux::test
