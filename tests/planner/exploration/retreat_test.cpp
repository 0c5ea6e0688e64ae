// Robots behind a passage that has closed, and what they do about it.

#include "exploration/exploration_state.hpp"
#include "planner/exploration/team_in_world.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/path_planner.hpp>

namespace frontlux::planner::detail {
namespace {

using test::key_at;
using Keys = std::vector<VoxelKey>;

constexpr double kResolution = 0.3;

// Two rooms of 18 x 9 x 3 m and 9 x 9 x 3 m, and a wall with a door of 1.5 m between them. At the far end of
// the first one is what there is to see; the robot has gone into the second one, where it has been in all
// corners.
struct TwoRooms {
  static constexpr KeyBox kFirst{key_at(-30, 0, 0), key_at(29, 29, 9)},
      kSecond{key_at(31, 0, 0), key_at(60, 29, 9)}, kWall{key_at(30, 0, 0), key_at(30, 29, 9)},
      kDoor{key_at(30, 13, 0), key_at(30, 17, 9)};
  ExplorationState state;
  ExplorationStep step;
  Pose start = at(10, 15);

  static Pose at(int x, int y) { return {Lattice(kResolution).exact_center(key_at(x, y, 5)), 0.0}; }

  /// @param beyond  [voxels] how thick the unknown space beyond the first room is
  /// @param holes  voxels of the rooms that are unknown
  TwoRooms(bool tours, int beyond, const Keys& holes = {})
      : state(options(tours), Mapping({kResolution, bounds(beyond)})) {
    const ExplorationStart begins{start, {}};
    state.start_from({&begins, 1});
    for (const KeyBox& part : {kFirst, kSecond, kDoor})
      for_each_key(part, [&](const VoxelKey& key) {
        if (std::ranges::find(holes, key) == holes.end()) state.changed.push_back(key);
      });
    state.mapping.mark_free(state.changed);
    for_each_key(kWall, [&](const VoxelKey& key) {
      if (kDoor.contains(key)) return;
      const Eigen::Vector3f middle = state.lattice().exact_center(key).cast<float>();
      state.mapping.insert(middle, {&middle, 1});
      state.changed.push_back(key);
    });
    std::ranges::sort(state.changed);
    if (tours) state.conservative_map.emplace(state.mapping.grid());
    state.frontiers.update(state.change());
    for (const Pose& place :
         {start, at(26, 15), at(34, 15), at(56, 26), at(34, 26), at(56, 4), at(34, 4), at(56, 15)})
      go_to(place);
    step = state.new_step();
    state.update_views(step);
  }
  /// For certain, in both maps.
  void occupy(const Keys& keys) {
    for (const VoxelKey& key : keys) {
      const Eigen::Vector3f middle = state.lattice().exact_center(key).cast<float>();
      for (int i = 0; i < 5; ++i) state.mapping.insert(middle, {&middle, 1});
    }
    state.changed = keys;
    state.conservative_map.emplace(state.mapping.grid());
  }
  static ExplorationOptions options(bool tours) {
    ExplorationOptions options = exploration_options();
    options.team.push_back({uav(), goal_options(uav())});
    options.tours = tours;
    return options;
  }
  static KeyBox bounds(int beyond) { return {key_at(-30 - beyond, 0, 0), kSecond.max}; }
  void go_to(const Pose& place) {
    state.trails[0].push_back(place);
    state.poses[0] = place;
  }
  void close_door() { state.block(0, test::keys_of(kDoor)); }
  Goal choose() {
    MotionState now;
    now.pose = state.poses[0];
    if (state.tours)
      state.plan_tours(0, {&now, 1}, step);
    else
      state.select_goals(step);
    return step.robots[0].goal;
  }
};

class Retreat : public testing::TestWithParam<bool> {};

TEST_P(Retreat, IsForRobotsThatCannotGoOn) {
  TwoRooms rooms(GetParam(), 5);
  const Goal goal = rooms.choose();
  ASSERT_TRUE(goal.pose);
  EXPECT_LT(goal.pose->position.x(), TwoRooms::at(30, 0).position.x());
  EXPECT_FALSE(rooms.state.is_cut_off(0, goal));
}

TEST_P(Retreat, LeadsThroughTheClosedPassageAndNowhereElse) {
  TwoRooms rooms(GetParam(), 5);
  rooms.close_door();
  const Goal goal = rooms.choose();
  ASSERT_EQ(goal.state, GoalState::kNothingAssigned);
  const std::vector<Pose> path = rooms.state.plan_retreat(0, goal);
  ASSERT_GE(path.size(), 2U);
  EXPECT_EQ(path.front().position, rooms.state.poses[0].position);
  EXPECT_EQ(path.back().position, TwoRooms::at(26, 15).position) << "its last place in the first room";
  const double straight = (path.back().position - path.front().position).norm();
  EXPECT_LT(path_length(path), 1.05 * straight) << "not by way of the corners where it has been";
  // If it still stands here, it tries the place before; after that it is cut off.
  const std::vector<Pose> longer = rooms.state.plan_retreat(0, goal);
  ASSERT_FALSE(longer.empty());
  EXPECT_EQ(longer.back().position, rooms.start.position);
  EXPECT_TRUE(rooms.state.plan_retreat(0, goal).empty());
  EXPECT_TRUE(rooms.state.is_cut_off(0, goal));
}

TEST_P(Retreat, IsNotWorthTakingWithNothingToSeeAtItsEnd) {
  TwoRooms rooms(GetParam(), 0);
  rooms.close_door();
  const Goal goal = rooms.choose();
  ASSERT_FALSE(goal.pose);
  EXPECT_TRUE(rooms.state.plan_retreat(0, goal).empty());
  EXPECT_FALSE(rooms.state.is_cut_off(0, goal));
}

// No sensor sees the floor on which its robot stands: a robot that drives starts without.
TEST(RetreatOnAPlane, MayLeadToTheStart) {
  const Robot robot = ugv();
  const KeyBox bounds{key_at(0, 0, 0), key_at(19, 19, 9)};
  ExplorationOptions options = exploration_options();
  options.team.push_back({robot, goal_options(robot)});
  ExplorationState state(options, Mapping({kResolution, bounds}));
  const VoxelKey start = key_at(10, 10, 4);
  // Down to the floor.
  const KeyBox known{key_at(0, 0, 2), bounds.max};
  const ExplorationStart begins{{state.lattice().exact_center(start), 0.0}, test::keys_of(known)};
  state.start_from({&begins, 1});
  state.mapping.mark_free(begins.known_free);
  TravelCorridor asks(robot.travel, state.lattice(), bounds);
  asks.update({state.mapping.grid()}, start);
  EXPECT_FALSE(asks.contains(start));
  TravelCorridor elsewhere(state.travel_by_voxels(0), state.lattice(), bounds);
  elsewhere.update({state.mapping.grid()}, start);
  EXPECT_TRUE(elsewhere.contains(start));
}

// What it has left closed is smaller than where it is: it has lost something to see, and not its path.
TEST(RetreatWithTours, ThatIsClosedToASmallPartCutsNobodyOff) {
  const Keys gap{key_at(-26, 15, 5)};  // where the sensor has been
  TwoRooms rooms(true, 5, gap);
  rooms.close_door();
  Keys pane;  // the first room but for its end
  for_each_key({key_at(-26, 0, 0), key_at(-26, 29, 9)}, [&](const VoxelKey& key) {
    if (key != gap.front()) pane.push_back(key);
  });
  rooms.occupy(pane);
  rooms.state.trails[0].insert(rooms.state.trails[0].begin(), TwoRooms::at(-28, 15));
  rooms.state.update_views(rooms.step);
  const Goal goal = rooms.choose();
  ASSERT_EQ(goal.state, GoalState::kNothingAssigned);
  const std::vector<Pose> path = rooms.state.plan_retreat(0, goal);
  ASSERT_FALSE(path.empty());
  EXPECT_EQ(path.back().position, TwoRooms::at(-28, 15).position);
  EXPECT_FALSE(rooms.state.is_cut_off(0, goal));
  // With the gap closed as well it does not go through: somebody has shut a door.
  rooms.occupy(gap);
  rooms.state.retreated_to[0].clear();
  EXPECT_TRUE(rooms.state.plan_retreat(0, goal).empty());
}

// Of what stands on its trail, what its body fills shuts nobody in, nor what stands where the robot has gone
// and come back; but what its body only reaches into does.
TEST(RetreatWithTours, LeavesWhatTheBodyFillsAndLoopsOfTheTrail) {
  enum class Stands { kInTheBody, kOnALoop, kBesideTheBody };
  for (const Stands stands : {Stands::kInTheBody, Stands::kOnALoop, Stands::kBesideTheBody}) {
    SCOPED_TRACE(static_cast<int>(stands));
    TwoRooms rooms(true, 5);
    Keys occupied{key_at(55, 15, 5)};
    if (stands == Stands::kOnALoop) {
      rooms.go_to(TwoRooms::at(56, 20));
      rooms.go_to(TwoRooms::at(56, 15));
      occupied.push_back(key_at(56, 18, 5));
    }
    Pose& pose = rooms.state.poses[0];
    if (stands != Stands::kBesideTheBody) pose.position.x() -= 0.1;  // so that it fills that voxel
    rooms.state.trails[0].push_back(pose);
    rooms.occupy(occupied);
    rooms.state.update_views(rooms.step);
    const Goal goal = rooms.choose();
    ASSERT_EQ(goal.state, GoalState::kNoCorridor);
    const std::vector<Pose> path = rooms.state.plan_retreat(0, goal);
    ASSERT_EQ(path.empty(), stands == Stands::kBesideTheBody);
    EXPECT_TRUE(path.empty() || path.back().position == TwoRooms::at(34, 4).position);
  }
}

// A door that a scan finds open while the robot keeps its stop is open at the next planning, when the robot
// is in it.
TEST(RetreatWithTours, IsOpenOnceAScanHasFoundItOpen) {
  const Keys door = test::keys_of(TwoRooms::kDoor);
  TwoRooms rooms(true, 5, door);
  const auto is_beyond = [&](const Goal& goal) {
    return goal.pose && goal.pose->position.x() < TwoRooms::at(0, 0).position.x();
  };
  EXPECT_FALSE(is_beyond(rooms.choose()));
  rooms.state.mapping.mark_free(door);
  if (rooms.state.conservative_map) rooms.state.conservative_map.emplace(rooms.state.mapping.grid());
  ExplorationStep seen = rooms.state.new_step();
  for (const VoxelKey& key : door)
    seen.robots[0].changed.push_back({key, Occupancy::kUnknown, Occupancy::kFree});
  seen.robots[0].goal = rooms.step.robots[0].goal;
  rooms.state.update_frontiers(seen);
  rooms.state.update_views(seen);
  EXPECT_TRUE(rooms.state.keep_stop(0, seen));
  rooms.go_to(TwoRooms::at(30, 15));  // into the door
  rooms.step = rooms.state.new_step();
  rooms.state.update_frontiers(rooms.step);
  rooms.state.update_views(rooms.step);
  EXPECT_TRUE(is_beyond(rooms.choose()));
}

// Where single voxels have stayed unknown there is no stop for a tour, however many they are.
TEST(RetreatWithTours, IsNotWorthTakingForWhatIsNoStop) {
  Keys holes;
  for (int y = 3; y < 30; y += 6)
    for (int x = 3; x < 30; x += 6) holes.push_back(key_at(x, y, 5));
  TwoRooms rooms(true, 0, holes);
  ASSERT_GT(rooms.state.frontiers.size(), 20U);
  rooms.close_door();
  const Goal goal = rooms.choose();
  ASSERT_EQ(goal.state, GoalState::kNothingAssigned);
  EXPECT_TRUE(rooms.state.plan_retreat(0, goal).empty());
  EXPECT_FALSE(rooms.state.is_cut_off(0, goal));
}

Scan without_rays(const Pose& from) {
  Scan scan;
  scan.origin = from.position.cast<float>();
  scan.max_range = 1.0;
  return scan;
}

// Steps that are taken again leave what was known of retreats then, also if the robot was held back on its
// way: at its first viewpoint, or before its last one, whose place the look at the obstacle has taken.
class RetreatRepeated : public testing::TestWithParam<bool> {};

TEST_P(RetreatRepeated, IsNotTriedOnceMore) {
  TwoRooms then(false, 5), now(false, 5);
  const Drive drive = [](std::size_t, const Pose& to) -> std::optional<Scan> {
    if (!GetParam() || to.position == TwoRooms::at(26, 15).position) return std::nullopt;
    return without_rays(to);
  };
  for (TwoRooms* rooms : {&then, &now}) {
    rooms->close_door();
    ASSERT_FALSE(rooms->choose().pose);
  }
  then.state.plan_paths(then.step);
  const std::size_t planned = then.step.robots[0].planned.size();
  ASSERT_GE(planned, 2U);
  then.state.execute_paths(ExplorationState::Gains(1), drive, then.step);
  EXPECT_EQ(then.step.robots[0].travelled, GetParam() ? planned : 1U);
  EXPECT_FALSE(then.step.robots[0].blocked.empty());
  const Drive anything = [](std::size_t, const Pose& to) { return without_rays(to); };
  ASSERT_TRUE(now.state.execute_again(then.step, anything, now.step));
  EXPECT_EQ(then.state.retreated_to, now.state.retreated_to);
  for (TwoRooms* rooms : {&then, &now}) {
    rooms->step = rooms->state.new_step();
    ASSERT_FALSE(rooms->choose().pose);
    rooms->state.plan_paths(rooms->step);
  }
  ASSERT_FALSE(then.step.robots[0].planned.empty());
  EXPECT_EQ(then.step.robots[0].planned.back().position, now.step.robots[0].planned.back().position);
}

INSTANTIATE_TEST_SUITE_P(HeldBack, RetreatRepeated, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "BeforeItsEnd" : "AtOnce"; });

INSTANTIATE_TEST_SUITE_P(Planners, Retreat, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Tours" : "Render"; });

}  // namespace
}  // namespace frontlux::planner::detail
