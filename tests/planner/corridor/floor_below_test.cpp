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

// If floor that opens closes a cell to the robot, there is a hole near what opened in the floor below the
// cell.
TEST(FloorBelow, HoldsTheHolesThatCloseACell) {
  Random random(3);
  for (const Motion motion : {Motion::kPlane, Motion::kGround}) {
    const TravelOptions travel = robot_on(motion);
    const FloorBelow below(travel, kResolution);
    int closed = 0;
    for (int round = 0; round < 60; ++round) {
      VoxelGrid grid(kResolution);
      const KeyBox room{key_at(0, 0, 0), key_at(24, 24, 14)};
      for_each_key(room, [&](const VoxelKey& key) {
        grid.set(key, key.z < room.min.z + 4 ? Occupancy::kOccupied : Occupancy::kFree);
      });
      const VoxelKey start = key_at(3, 3, 9);
      const auto passable = [&] {
        TravelCorridor corridor(travel, grid.lattice(), room);
        corridor.update({grid}, start);
        std::vector<VoxelKey> cells;
        for_each_key({key_at(3, 3, 8), key_at(21, 21, 10)}, [&](const VoxelKey& cell) {
          if (corridor.passable(cell)) cells.push_back(cell);
        });
        std::ranges::sort(cells);
        return cells;
      };
      // A pit of up to 3 x 3 voxels grows voxel by voxel, on the ground column by column.
      const VoxelKey corner = key_at(8 + random.below(9), 8 + random.below(9), 3);
      std::vector<VoxelKey> cells = passable();
      for (int steps = 3 + random.below(6); steps > 0; --steps) {
        const VoxelKey top = *offset_key(corner, random.below(3), random.below(3), 0);
        std::vector<VoxelKey> opened{top};
        if (motion == Motion::kGround)
          for (int z = 1; z < 4; ++z) opened.push_back(*offset_key(top, 0, 0, -z));
        std::erase_if(opened, [&](const VoxelKey& key) { return grid.at(key) == Occupancy::kFree; });
        for (const VoxelKey& key : opened) grid.set(key, Occupancy::kFree);
        const std::vector<VoxelKey> left = passable();
        for (const VoxelKey& cell : cells) {
          if (std::ranges::binary_search(left, cell)) continue;
          ++closed;
          std::vector<VoxelKey> floor;
          below.for_each(cell, [&](const VoxelKey& key) { floor.push_back(key); });
          bool found = false;
          for (const VoxelKey& key : opened) {
            if (std::ranges::find(floor, key) == floor.end()) continue;
            EXPECT_TRUE(below.contains(cell, key));
            below.for_each_hole_near(
                grid, key, [&](const VoxelKey& hole) { found = found || below.contains(cell, hole); });
          }
          EXPECT_TRUE(found) << round;
        }
        cells = left;
      }
    }
    EXPECT_GT(closed, 500) << name_of(motion);
  }
}

TEST(FloorBelow, IsNoneOfARobotThatNeedsNone) {
  TravelOptions lenient = robot_on(Motion::kPlane);
  lenient.require_ground = false;
  for (const TravelOptions& travel : {uav_travel(), lenient}) {
    const FloorBelow below(travel, kResolution);
    below.for_each(key_at(5, 5, 5), [](const VoxelKey&) { ADD_FAILURE(); });
    EXPECT_FALSE(below.contains(key_at(5, 5, 5), key_at(5, 5, 4)));
    below.for_each_hole_near(VoxelGrid(kResolution), key_at(5, 5, 4), [](const VoxelKey&) { ADD_FAILURE(); });
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
