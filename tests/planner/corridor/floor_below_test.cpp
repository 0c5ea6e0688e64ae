// The floor under a robot that drives, and where its sensor is above it, against the corridor and by hand.

#include "corridor/floor_below.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/robot.hpp>

namespace frontlux::planner::detail {
namespace {

using test::key_at;
using test::Random;

constexpr double kResolution = 0.1;

TravelOptions robot_on(Motion motion) {
  TravelOptions travel;
  travel.motion = motion;
  travel.extents = {0.5, 0.5, 0.4};
  travel.sensor_height = 0.55;
  travel.ground_extents = Eigen::Vector2d(0.5, 0.3);
  return travel;
}

// If a floor voxel that opens closes a cell to the robot, it is a hole of the floor below that cell.
TEST(FloorBelow, HoldsTheHolesThatCloseACell) {
  Random random(3);
  int closed = 0;
  for (const Motion motion : {Motion::kPlane, Motion::kGround})
    for (int round = 0; round < 60; ++round) {
      const TravelOptions travel = robot_on(motion);
      const FloorBelow below(travel, kResolution);
      VoxelGrid grid(kResolution);
      const KeyBox room{key_at(0, 0, 0), key_at(24, 24, 14)};
      for_each_key(room, [&](const VoxelKey& key) {
        grid.set(key, key.z < room.min.z + 4 ? Occupancy::kOccupied : Occupancy::kFree);
      });
      // A trench one voxel wide, over which robots get, and single voxels elsewhere.
      const VoxelKey trench = key_at(8 + random.below(9), 8 + random.below(9), 3);
      const int depth = random.below(3), length = 1 + random.below(4);
      for (int y = 0; y < length; ++y)
        for (int z = 0; z <= depth; ++z)
          if (const auto key = offset_key(trench, 0, y, -z)) grid.set(*key, Occupancy::kFree);
      for (int i = random.below(10); i > 0; --i)
        grid.set(key_at(random.below(25), random.below(25), random.below(4)), Occupancy::kFree);
      TravelCorridor corridor(travel, grid.lattice(), room);
      const VoxelKey start = key_at(12, 12, 9);
      corridor.update({grid}, start);
      std::vector<VoxelKey> passed;
      for_each_key({key_at(3, 3, 8), key_at(21, 21, 10)}, [&](const VoxelKey& cell) {
        if (corridor.passable(cell)) passed.push_back(cell);
      });
      const VoxelKey opened =
          *offset_key(trench, random.one_in(2) ? 1 : -1, random.below(length), -random.below(2));
      if (grid.at(opened) == Occupancy::kFree) continue;
      grid.set(opened, Occupancy::kFree);
      TravelCorridor now(travel, grid.lattice(), room);
      now.update({grid}, start);
      for (const VoxelKey& cell : passed) {
        if (now.passable(cell)) continue;
        EXPECT_TRUE(below.contains(cell, opened)) << round;
        std::vector<VoxelKey> floor;
        below.for_each(cell, [&](const VoxelKey& key) { floor.push_back(key); });
        EXPECT_NE(std::ranges::find(floor, opened), floor.end());
        EXPECT_TRUE(std::ranges::any_of(floor, [&](const VoxelKey& key) {
          return grid.at(key) == Occupancy::kFree && below.is_hole(grid, key);
        })) << round;
        ++closed;
      }
    }
  EXPECT_GT(closed, 100);
}

TEST(FloorBelow, IsNoneOfARobotThatNeedsNone) {
  TravelOptions lenient = robot_on(Motion::kPlane);
  lenient.require_ground = false;
  for (const TravelOptions& travel : {uav_travel(), lenient}) {
    const FloorBelow below(travel, kResolution);
    below.for_each(key_at(5, 5, 5), [](const VoxelKey&) { ADD_FAILURE(); });
    EXPECT_FALSE(below.contains(key_at(5, 5, 5), key_at(5, 5, 4)));
    EXPECT_FALSE(below.is_hole(VoxelGrid(kResolution), key_at(5, 5, 4)));
  }
}

// Of a robot that drives above the face on which it stands, whatever the voxels; in space in the middle.
TEST(PlaceInACell, IsAtTheSensorsHeight) {
  for (const double resolution : {0.1, 0.19, 0.2, 0.27, 0.3, 0.4})
    for (const double height : {0.0, 0.3, 0.55, 0.6, 0.75, 1.2}) {
      TravelOptions travel = robot_on(Motion::kPlane);
      travel.extents = {0.5, 0.5, 0.5};
      travel.sensor_height = height;
      const Lattice lattice(resolution);
      const TravelCorridor corridor(travel, lattice, {key_at(0, 0, 0), key_at(20, 20, 20)});
      const int layers = static_cast<int>(std::floor(height / resolution + 1e-9));
      const VoxelKey floor = key_at(7, 7, 3), cell = key_at(7, 7, 3 + layers);
      const Eigen::Vector3d place = corridor.place_in(cell);
      const double face = lattice.exact_center(floor).z() - resolution / 2;
      EXPECT_NEAR(place.z(), face + height, 2e-6) << resolution << " " << height;
      EXPECT_EQ(lattice.key(place), cell) << resolution << " " << height;
      EXPECT_EQ(place.head<2>(), lattice.exact_center(cell).head<2>());
    }
  const Lattice lattice(0.3);
  const TravelCorridor in_space(uav_travel(), lattice, {key_at(0, 0, 0), key_at(20, 20, 20)});
  EXPECT_EQ(in_space.place_in(key_at(7, 8, 9)), lattice.exact_center(key_at(7, 8, 9)));
}

// Half of what the voxels leave the body to each side, at most 5 cm.
TEST(InMotion, GivesAMarginAndTheLeastHeight) {
  EXPECT_DOUBLE_EQ(in_motion(uav(), 0.3).travel.margin, 0.025);  // 0.9 - 0.8 = 0.1
  EXPECT_DOUBLE_EQ(in_motion(uav(), 0.2).travel.margin, 0.05);   // 1.0 - 0.8 = 0.2
  EXPECT_DOUBLE_EQ(in_motion(ugv(), 0.3).travel.margin, 0.05);   // 1.5 - 1.0 = 0.5
  EXPECT_DOUBLE_EQ(in_motion(ugv(), 0.2).travel.margin, 0.0);    // 1.0 - 1.0 = 0
  EXPECT_DOUBLE_EQ(in_motion(uav(), 0.3).travel.min_height, 0.4);
  EXPECT_EQ(in_motion(ugv(), 0.3).travel.min_height, ugv().travel.min_height);
  EXPECT_THROW(static_cast<void>(in_motion(uav(), 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::planner::detail
