// What tours go for when nobody sees a cluster of the usual size.

#include "support/views.hpp"
#include "support/voxel_keys.hpp"
#include "tour/tour_planning.hpp"

#include <frontlux/frontier_set.hpp>

namespace frontlux::planner::detail {
namespace {

constexpr double kResolution = 0.2;

// A hall whose floor is unknown in a strip across it, wider than what the robot on the floor gets over, and
// flat: it sees the strip's voxels from the side only. Beyond, an opening in the end wall is in its view.
struct ShutIn {
  static constexpr int kFloor = 32767;
  const KeyBox bounds{make_key(32750, 32757, kFloor), make_key(32810, 32773, kFloor + 14)};
  const KeyBox strip{make_key(32774, 32757, kFloor), make_key(32778, 32773, kFloor)};
  const KeyBox opening{make_key(32810, 32757, kFloor + 1), make_key(32810, 32773, kFloor + 14)};
  const std::vector<VoxelKey> cells{make_key(32762, 32765, kFloor + 4), make_key(32800, 32765, kFloor + 8)};
  VoxelGrid grid{kResolution};
  std::vector<Robot> robots{{"ugv", {}, test::lidar(5.0), {}}, {"uav", {}, test::camera(8.0), {}}};
  std::vector<MotionState> starts = std::vector<MotionState>(2);
  std::optional<TourPlanning> planning;

  explicit ShutIn(Occupancy end, const TourPlanning::Options& options = {}) {
    robots[0].travel.motion = Motion::kPlane;
    robots[0].travel.extents = {0.6, 0.6, 0.6};
    robots[0].travel.sensor_height = 0.7;
    robots[1].travel.extents = {0.4, 0.4, 0.4};
    robots[1].travel.min_height = -100.0;
    test::fill(grid, {make_key(32750, 32757, kFloor + 1), bounds.max}, Occupancy::kFree);
    test::fill(grid, {bounds.min, make_key(32810, 32773, kFloor)}, Occupancy::kOccupied);
    test::fill(grid, strip, Occupancy::kUnknown);
    test::fill(grid, opening, end);
    std::vector<Pose> poses;
    for (std::size_t r = 0; r < 2; ++r) {
      starts[r].pose.position = grid.lattice().exact_center(cells[r]);
      poses.push_back(starts[r].pose);
    }
    planning.emplace(robots, poses, grid.lattice(), bounds, options);
  }
  void plan(std::size_t robot, std::span<const VoxelKey> blocked = {}) {
    TravelCorridor corridor(robots[robot].travel, grid.lattice(), bounds);
    corridor.block(blocked);
    corridor.update({grid}, cells[robot]);
    const auto caster = make_grid_ray_caster(grid);
    const FrontierSet frontiers(grid, bounds);
    planning->update({robot, *caster, grid, corridor, frontiers.keys(), starts});
  }
};

TEST(WorthOfStops, LooksAtTheFloorThatShutsARobotIn) {
  ShutIn hall(Occupancy::kUnknown);
  hall.plan(1);
  ASSERT_FALSE(hall.planning->tour(1).empty());
  hall.plan(0);
  ASSERT_FALSE(hall.planning->can_reach(0, make_key(32790, 32765, ShutIn::kFloor + 4)));
  ASSERT_FALSE(hall.planning->tour(0).empty()) << "it rests for good";
  EXPECT_TRUE(hall.planning->can_reach(0, hall.planning->tour(0).front().cell));
  ASSERT_FALSE(hall.planning->first_view(0).empty());
  for (const VoxelKey& key : hall.planning->first_view(0)) EXPECT_TRUE(hall.strip.contains(key));
}

// Others see something that it would not see from anywhere.
TEST(WorthOfStops, LeavesFlatPatchesThatKeepNobodyFromAnything) {
  ShutIn hall(Occupancy::kOccupied);
  test::fill(hall.grid,
             {make_key(32798, 32757, ShutIn::kFloor + 12), make_key(32810, 32761, ShutIn::kFloor + 14)},
             Occupancy::kUnknown);
  hall.plan(1);
  ASSERT_FALSE(hall.planning->tour(1).empty());
  hall.plan(0);
  EXPECT_TRUE(hall.planning->tour(0).empty());
}

// A closed hall, all of it known but what begins at an opening in its end wall: so many layers of voxels.
struct Opening {
  static constexpr KeyBox kHall{{32750, 32750, 32768}, {32829, 32800, 32779}};
  static constexpr KeyBox kSpace = grown(kHall, 12, 1, 1);
  VoxelGrid grid{kResolution};
  Robot robot{"uav", {}, test::camera(5.0), {}};
  std::optional<TourPlanning> planning;

  Opening(int width, int height, int depth) {
    robot.travel.extents = {0.4, 0.4, 0.4};
    robot.travel.min_height = -100.0;
    test::fill(grid, kSpace, Occupancy::kOccupied);
    test::fill(grid, kHall, Occupancy::kFree);
    test::fill(grid, {make_key(32830, 32770, 32768), make_key(32830, 32769 + width, 32767 + height)},
               Occupancy::kUnknown);
    if (depth > 1)  // a room, or the inside of a wall
      test::fill(grid, {make_key(32831, 32755, 32768), make_key(32829 + depth, 32795, 32779)},
                 Occupancy::kUnknown);
    const VoxelKey at = make_key(32810, 32775, 32773);
    MotionState start;
    start.pose.position = grid.lattice().exact_center(at);
    planning.emplace(std::vector{robot}, std::span(&start.pose, 1), grid.lattice(), kSpace,
                     TourPlanning::Options{});
    TravelCorridor corridor(robot.travel, grid.lattice(), kSpace);
    corridor.update({grid}, at);
    const auto caster = make_grid_ray_caster(grid);
    const FrontierSet frontiers(grid, kSpace);
    planning->update({0, *caster, grid, corridor, frontiers.keys(), {&start, 1}});
  }
  [[nodiscard]] std::size_t stops() const { return planning->tour(0).size(); }
};

TEST(WorthOfStops, LeadsThroughNarrowDoorsAtTheEnd) {
  EXPECT_EQ(Opening(3, 10, 10).stops(), 1U) << "1.2 m2, 30 frontiers";
  EXPECT_EQ(Opening(4, 4, 10).stops(), 1U) << "0.64 m2, 16";
  EXPECT_EQ(Opening(3, 4, 10).stops(), 0U) << "0.48 m2, 12";
  EXPECT_EQ(Opening(3, 10, 1).stops(), 0U) << "a niche";
  EXPECT_EQ(Opening(3, 10, 7).stops(), 0U) << "a crack in a wall that is hollow, 1.2 m";
  EXPECT_EQ(Opening(3, 10, 8).stops(), 1U) << "a closet, 1.4 m";
}

// One robot sees nothing, and another one can get nowhere: that smaller clusters are worth a stop from now on
// is decided once it stays so.
TEST(WorthOfStops, AsksForNoLessWhileARobotIsStuckForAMoment) {
  const TourPlanning::Options options{.least_gain = 30.0};
  ShutIn hall(Occupancy::kOccupied, options);
  test::fill(hall.grid,
             {make_key(32798, 32757, ShutIn::kFloor + 12), make_key(32810, 32761, ShutIn::kFloor + 14)},
             Occupancy::kUnknown);
  hall.plan(1);
  ASSERT_FALSE(hall.planning->tour(1).empty());
  const double before = hall.planning->least_gain(0);
  hall.plan(1, {&hall.cells[1], 1});
  ASSERT_TRUE(hall.planning->tour(1).empty());
  hall.plan(0);
  EXPECT_EQ(hall.planning->least_gain(0), before);
  hall.plan(1, {&hall.cells[1], 1});
  hall.plan(0);
  EXPECT_LT(hall.planning->least_gain(0), before);
}

}  // namespace
}  // namespace frontlux::planner::detail
