// Corridors of round bodies: against the distances of cubes, and where only they fit.

#include "planner/corridor/body_oracle.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

#include <frontlux/planner/travel_corridor.hpp>

namespace frontlux::planner {
namespace {

using test::key_at;
using test::Random;

const KeyBox kBounds{key_at(-12, -10, -9), key_at(13, 11, 10)};

// Cell by cell: whether no cube that is not known to be free is nearer than the margin.
bool fits(const TravelOptions& travel, const VoxelGrid& grid, const VoxelKey& cell) {
  constexpr double kSlack = 1e-9;  // of a voxel
  const Eigen::Vector3d at = grid.lattice().exact_center(cell);
  return all_of(test::voxels_near(travel, grid.lattice(), at), [&](const VoxelKey& key) {
    return (kBounds.contains(key) && grid.at(key) == Occupancy::kFree) ||
           test::depth_in(travel, at, test::cube_of(grid.lattice(), key)) <= kSlack * grid.resolution();
  });
}

// After every change also the same as a corridor made anew.
TEST(RoundCorridor, KeepsTheMarginToCubesThatAreNotFree) {
  std::size_t open = 0, closed = 0;
  int number = 0;
  for (const double resolution : {0.1, 0.2, 0.3})
    for (const TravelOptions& travel : test::bodies_in_space()) {
      if (++number % 4 != 0) continue;
      SCOPED_TRACE(testing::Message()
                   << resolution << " m, shape " << static_cast<int>(travel.shape) << " of "
                   << travel.extents.transpose() << ", margin " << travel.margin);
      Random random(static_cast<std::uint64_t>(number));
      VoxelGrid grid(resolution);
      for_each_key(kBounds, [&](const VoxelKey& key) {
        grid.set(key, random.one_in(600) ? random.state() : Occupancy::kFree);
      });
      TravelCorridor corridor(travel, grid.lattice(), kBounds);
      corridor.update({grid}, key_at(0, 0, 0));
      for (int round = 0; round < 4; ++round) {
        TravelCorridor fresh(travel, grid.lattice(), kBounds);
        fresh.update({grid}, key_at(0, 0, 0));
        ASSERT_TRUE(std::ranges::equal(corridor.cells(), fresh.cells()));
        for_each_key(kBounds, [&](const VoxelKey& key) {
          ASSERT_EQ(corridor.passable(key), fresh.passable(key));
          if (!random.one_in(round == 3 ? 2 : 20)) return;
          const bool expected = fits(travel, grid, key);
          ASSERT_EQ(corridor.passable(key), expected);
          (expected ? open : closed) += 1;
        });
        std::vector<VoxelKey> changed;
        for (int n = random.below(30); n >= 0; --n) {
          const VoxelKey key = random.key_in(grown(kBounds, 2));
          grid.set(key, random.one_in(2) ? random.state() : Occupancy::kFree);
          changed.push_back(key);
        }
        corridor.update({grid, changed}, key_at(0, 0, 0));
      }
    }
  EXPECT_GT(open, 20'000U);
  EXPECT_GT(closed, 20'000U);
}

// Two rooms, and a wall with a slit through it along the diagonal. Between the walls of the slit a cylinder
// of 3.5 voxels' radius has just room on its way, in steps along the axes; the box around it meets their
// corners.
TEST(RoundCorridor, PassesADiagonalSlitThatTheBoxAroundDoesNot) {
  constexpr int kWidth = 6;  // [voxels] across the slit along each axis, on both sides of its middle
  const KeyBox bounds{key_at(-30, -30, 0), key_at(30, 30, 9)};
  for (const Motion motion : {Motion::kSpace, Motion::kPlane}) {
    VoxelGrid grid(0.1);
    for_each_key(bounds, [&](const VoxelKey& key) {
      const int x = key.x - Lattice::kOrigin, y = key.y - Lattice::kOrigin;
      const bool wall = std::abs(x + y) <= 16 && std::abs(x - y) > kWidth;
      grid.set(key, wall ? Occupancy::kOccupied : Occupancy::kFree);
    });
    TravelOptions travel;
    travel.motion = motion;
    travel.extents = {0.6, 0.6, 0.5};
    travel.margin = 0.05;
    travel.sensor_height = 0.4;
    travel.require_ground = false;
    travel.min_height = 0.0;
    const auto passes = [&](BodyShape shape, double width) {
      travel.shape = shape;
      travel.extents = {width, width, shape == BodyShape::kSphere ? width : 0.5};
      TravelCorridor corridor(travel, grid.lattice(), bounds);
      corridor.update({grid}, key_at(-18, -18, 4));
      EXPECT_EQ(corridor.state(), CorridorState::kReady);
      return corridor.contains(key_at(18, 18, 4));
    };
    EXPECT_FALSE(passes(BodyShape::kBox, 0.6));
    EXPECT_TRUE(passes(BodyShape::kBox, 0.4));
    EXPECT_TRUE(passes(BodyShape::kCylinder, 0.6));
    EXPECT_TRUE(passes(BodyShape::kSphere, 0.6));
    // (6 - 1) / sqrt(2) voxels are 0.3536 m, 5 cm of it margin.
    EXPECT_TRUE(passes(BodyShape::kCylinder, 0.607));
    EXPECT_FALSE(passes(BodyShape::kCylinder, 0.608));
  }
}

TEST(RoundCorridor, RefusesShapesThatTheExtentsAreNotOf) {
  const Lattice lattice(0.1);
  TravelOptions travel;
  travel.extents = {0.5, 0.6, 0.3};
  TravelCorridor box(travel, lattice, kBounds);
  const auto complains = [&](BodyShape shape, const Eigen::Vector3d& extents, const std::string& part) {
    travel.shape = shape;
    travel.extents = extents;
    test::expect_complaint([&] { static_cast<void>(TravelCorridor(travel, lattice, kBounds)); }, {part});
  };
  complains(BodyShape::kCylinder, {0.5, 0.6, 0.3}, "extents.y is 0.600000 m");
  complains(BodyShape::kSphere, {0.5, 0.6, 0.5}, "extents.y is 0.600000 m");
  complains(BodyShape::kSphere, {0.5, 0.5, 0.3}, "extents.z is 0.300000 m");
}

}  // namespace
}  // namespace frontlux::planner
