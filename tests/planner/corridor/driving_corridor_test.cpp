// Corridors of robots that drive: where floor, slopes and steps let them go.

#include "corridor/whole_voxels.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/travel_corridor.hpp>

namespace frontlux::planner {
namespace {

using test::key_at;

const KeyBox kBounds{key_at(-13, -10, -5), key_at(14, 12, 11)};

TEST(TravelCorridor, KeepsToGround) {
  VoxelGrid grid(0.3);
  for_each_key(kBounds, [&](const VoxelKey& key) {
    if (key.z >= 32768) grid.set(key, Occupancy::kFree);
    // Rings of floor every third voxel along x, up to a platform's edge at x = 6, beyond which it is open.
    if (key.z == 32767 && key.x <= 32768 + 6 && key.x % 3 == 32768 % 3) grid.set(key, Occupancy::kOccupied);
    if (key.z == 32767 && key.x > 32768 + 9) grid.set(key, Occupancy::kFree);
  });
  TravelCorridor corridor(ugv_travel(), grid.lattice(), kBounds);
  corridor.update({grid}, key_at(0, 0, 2));
  ASSERT_EQ(corridor.state(), CorridorState::kReady);
  int farthest = 0;
  for (const VoxelKey& key : corridor.cells()) farthest = std::max(farthest, key.x - 32768);
  EXPECT_EQ(farthest, 7);  // the last ring's neighbour, and two voxels from what is known to be open

  corridor.update({grid}, key_at(9, 0, 2));
  EXPECT_EQ(corridor.state(), CorridorState::kWithoutGround);
  EXPECT_TRUE(corridor.cells().empty());

  TravelOptions lenient = ugv_travel();
  lenient.require_ground = false;
  TravelCorridor flying(lenient, grid.lattice(), kBounds);
  flying.update({grid}, key_at(0, 0, 2));
  for (const VoxelKey& key : flying.cells()) farthest = std::max(farthest, key.x - 32768);
  EXPECT_EQ(farthest, 12);  // half a box from the bounds
}

// On its plane, wherever the bounds are along z.
TEST(TravelCorridor, KeepsOutOfBoxesOnAnyPlane) {
  VoxelGrid grid(0.3);
  for_each_key(kBounds, [&](const VoxelKey& key) { grid.set(key, Occupancy::kFree); });
  TravelOptions options = ugv_travel();
  options.require_ground = false;
  KeyBox high = kBounds;
  high.min.z = high.max.z;
  for (const KeyBox& bounds : {kBounds, high}) {
    TravelCorridor corridor(options, grid.lattice(), bounds);
    corridor.keep_out_of({{key_at(4, -10, 2), key_at(6, 12, 2)}});
    corridor.update({grid}, key_at(0, 0, 2));
    ASSERT_EQ(corridor.state(), CorridorState::kReady);
    int farthest = 0;
    for (const VoxelKey& key : corridor.cells()) farthest = std::max(farthest, key.x - 32768);
    EXPECT_EQ(farthest, 3) << bounds.min.z;
  }
}

// A floor, a ramp as steep as its number of voxels along x for each one up, and a floor above.
VoxelGrid ramp(int run, int rise) {
  VoxelGrid grid(0.1);
  for_each_key(kBounds, [&](const VoxelKey& key) {
    const int x = key.x - Lattice::kOrigin, z = key.z - Lattice::kOrigin;
    const int top = x < 0 ? 0 : std::min(x / run, rise);
    grid.set(key, z == top || (z < top && x % run == 0) ? Occupancy::kOccupied
                  : z > top                             ? Occupancy::kFree
                                                        : Occupancy::kUnknown);
  });
  return grid;
}

TravelOptions small_ugv() {
  TravelOptions options;
  options.motion = Motion::kGround;
  options.extents = {0.5, 0.5, 0.3};
  options.sensor_height = 0.3;
  return options;
}

TEST(TravelCorridor, DrivesUpSlopesAndStepsThatAreNotTooHigh) {
  const auto farthest = [](const VoxelGrid& grid, const TravelOptions& options) {
    TravelCorridor corridor(options, grid.lattice(), kBounds);
    corridor.update({grid}, key_at(-6, 0, 4));
    EXPECT_EQ(corridor.state(), CorridorState::kReady);
    VoxelKey far = key_at(-6, 0, 4);
    for (const VoxelKey& key : corridor.cells())
      if (key.x > far.x) far = key;
    return std::pair(far.x - Lattice::kOrigin, far.z - Lattice::kOrigin);
  };
  TravelOptions options = small_ugv();
  EXPECT_EQ(farthest(ramp(3, 3), options), std::pair(12, 7));
  EXPECT_LT(farthest(ramp(1, 5), options).first, 4) << "too steep";
  EXPECT_EQ(farthest(ramp(40, 0), options), std::pair(12, 4));

  // A step, as high as it may be and a voxel higher.
  const auto step = [](int height) {
    VoxelGrid grid = ramp(40, 0);
    test::fill(grid, {key_at(3, -10, 1), key_at(14, 12, height)}, Occupancy::kOccupied);
    return grid;
  };
  EXPECT_EQ(farthest(step(1), options), std::pair(12, 5));
  EXPECT_EQ(farthest(step(2), options), std::pair(3, 4)) << "up to it";
  options.step = 0.25;
  EXPECT_EQ(farthest(step(2), options), std::pair(12, 6));
  EXPECT_EQ(farthest(step(3), options), std::pair(3, 4));

  // An edge beyond which it goes far down.
  VoxelGrid edge = ramp(40, 0);
  test::fill(edge, {key_at(3, -10, -5), key_at(14, 12, 0)}, Occupancy::kFree);
  EXPECT_EQ(farthest(edge, small_ugv()).first, 0) << "half of its body before the edge";

  // A gap across, as wide as a step may be and wider.
  const auto gap = [](int width) {
    VoxelGrid grid = ramp(40, 0);
    test::fill(grid, {key_at(3, -10, -5), key_at(2 + width, 12, 0)}, Occupancy::kFree);
    return grid;
  };
  options.step = 0.15;
  EXPECT_EQ(farthest(gap(1), options), std::pair(12, 4));
  EXPECT_EQ(farthest(gap(2), options), std::pair(0, 4)) << "half of its body before the gap";
  options.step = 0.25;
  EXPECT_EQ(farthest(gap(2), options), std::pair(12, 4));
  EXPECT_EQ(farthest(gap(3), options), std::pair(0, 4));
}

// Where a gap ends is in another brick than the gap.
TEST(TravelCorridor, FollowsGapsWhoseSidesChange) {
  VoxelGrid grid = ramp(40, 0);
  test::fill(grid, {key_at(7, -10, -5), key_at(8, 12, 0)}, Occupancy::kFree);
  TravelCorridor corridor(small_ugv(), grid.lattice(), kBounds);
  corridor.update({grid}, key_at(-6, 0, 4));
  const KeyBox side{key_at(7, -10, -5), key_at(7, 12, 0)};
  std::vector<VoxelKey> changed;
  for_each_key(side, [&](const VoxelKey& key) { changed.push_back(key); });
  for (const Occupancy state : {Occupancy::kOccupied, Occupancy::kFree}) {
    test::fill(grid, side, state);
    corridor.update({grid, changed}, key_at(-6, 0, 4));
    TravelCorridor anew(small_ugv(), grid.lattice(), kBounds);
    anew.update({grid}, key_at(-6, 0, 4));
    EXPECT_TRUE(std::ranges::equal(corridor.cells(), anew.cells()));
    const bool crosses = corridor.contains(key_at(11, 0, 4));
    EXPECT_EQ(crosses, state == Occupancy::kOccupied);
  }
}

// A voxel beside a gap decides about cells from which the gap is under the robot's edge.
TEST(TravelCorridor, SidesOfGapsDecideWithinTheirReach) {
  VoxelGrid grid = ramp(40, 0);
  test::fill(grid, {key_at(8, -10, -5), key_at(8, 12, 0)}, Occupancy::kFree);
  TravelCorridor corridor(small_ugv(), grid.lattice(), kBounds);
  corridor.update({grid}, key_at(-6, 0, 4));
  const VoxelKey side = key_at(9, 0, 0), cell = key_at(6, 0, 4);
  ASSERT_TRUE(corridor.fits(cell));
  grid.set(side, Occupancy::kFree);
  corridor.update({grid, {&side, 1}}, key_at(-6, 0, 4));
  EXPECT_FALSE(corridor.fits(cell));
  const auto [x, y, z] = detail::deciding_reach(small_ugv(), grid.resolution());
  EXPECT_TRUE(grown({side, side}, x, y, z).contains(cell));
}

}  // namespace
}  // namespace frontlux::planner
