// Stencils of round bodies and boxes against the distances of cubes, and what holds off the middle of a cell.

#include "planner/corridor/body_oracle.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/path_planner.hpp>

namespace frontlux::planner {
namespace {

using test::key_at;
using test::Random;

constexpr double kSlack = 1e-9;  // of a voxel
const VoxelKey kCell = key_at(0, 0, 0);

TEST(BodyStencil, HoldsTheVoxelsThatAreNearerThanTheMargin) {
  std::size_t in = 0, beside = 0;
  for (const double resolution : {0.1, 0.15, 0.25, 0.3})
    for (const TravelOptions& travel : test::bodies_in_space()) {
      const Lattice lattice(resolution);
      const BodyStencil stencil(travel, resolution);
      std::size_t count = 0;
      for_each_key(grown({kCell, kCell}, 7), [&](const VoxelKey& key) {
        const double depth = test::depth_in(travel, lattice.exact_center(kCell), test::cube_of(lattice, key));
        const bool expected = depth > kSlack * resolution;
        ASSERT_EQ(stencil.contains(kCell, key), expected)
            << resolution << " m, " << travel.extents.transpose() << ", margin " << travel.margin;
        count += expected ? 1 : 0;
      });
      const KeyBox box = stencil.box_around(kCell);
      EXPECT_EQ(box, voxels_of_cell(travel, lattice, kCell));
      EXPECT_EQ(stencil.is_box(), count == size_of(box));
      EXPECT_TRUE(travel.shape != BodyShape::kBox || stencil.is_box());
      std::size_t visited = 0;
      EXPECT_TRUE(stencil.all_of(kCell, [&](const VoxelKey&) { return ++visited > 0; }));
      EXPECT_EQ(visited, count);
      in += count;
      beside += size_of(box) - count;
    }
  EXPECT_GT(in, 1'000U);
  EXPECT_GT(beside, 1'000U) << "round bodies leave corners open";
}

TEST(BodyStencil, OfARobotThatDrivesHasTheLayersOfItsBox) {
  for (const Motion motion : {Motion::kPlane, Motion::kGround}) {
    TravelOptions box;
    box.motion = motion;
    box.extents = {0.7, 0.7, 0.7};
    box.margin = 0.05;
    TravelOptions cylinder = box, sphere = box;
    cylinder.shape = BodyShape::kCylinder;
    sphere.shape = BodyShape::kSphere;
    const BodyStencil of_box(box, 0.1), of_cylinder(cylinder, 0.1), of_sphere(sphere, 0.1);
    EXPECT_EQ(of_box.low(), of_cylinder.low());
    EXPECT_EQ(of_box.high(), of_cylinder.high());
    int columns = 0;
    for (int x = of_box.low()[0]; x <= of_box.high()[0]; ++x)
      for (int y = of_box.low()[1]; y <= of_box.high()[1]; ++y) {
        const auto& [low, high] = of_cylinder.column(x, y);
        const double side = std::hypot(std::max(std::abs(x) - 0.5, 0.0), std::max(std::abs(y) - 0.5, 0.0));
        EXPECT_EQ(low <= high, side < 4.0 - kSlack);
        EXPECT_TRUE(low > high || (low == of_box.low()[2] && high == of_box.high()[2]));
        // A sphere counts as the cylinder around it.
        EXPECT_EQ(low, of_sphere.column(x, y).low);
        EXPECT_EQ(high, of_sphere.column(x, y).high);
        columns += low <= high ? 1 : 0;
      }
    EXPECT_GT(columns, 50);
    EXPECT_LT(columns, 81);
    EXPECT_EQ(of_cylinder.reach().z(), 0.0);
  }
}

TEST(BodyStencil, EndsWithTheKeyRange) {
  TravelOptions travel;
  travel.shape = BodyShape::kSphere;
  travel.extents = Eigen::Vector3d::Constant(0.7);
  const BodyStencil stencil(travel, 0.1);
  for (const VoxelKey& cell : {VoxelKey{0, 0, 0}, VoxelKey{65535, 65535, 65535}, VoxelKey{1, 65534, 30}}) {
    std::size_t expected = 0, visited = 0;
    for (int x = -4; x <= 4; ++x)
      for (int y = -4; y <= 4; ++y)
        for (int z = -4; z <= 4; ++z) {
          const auto key = offset_key(cell, x, y, z);
          expected += key && stencil.contains(key_at(0, 0, 0), key_at(x, y, z)) ? 1 : 0;
        }
    EXPECT_TRUE(stencil.all_of(cell, [&](const VoxelKey&) { return ++visited > 0; }));
    EXPECT_EQ(visited, expected);
  }
}

// By hand. Where the voxels around leave room, a round body needs no other cell than its own.
TEST(BodyStencil, ReachIsNoMoreThanTheBodyNeeds) {
  const auto reach = [](BodyShape shape, double width, double resolution) {
    TravelOptions travel;
    travel.shape = shape;
    travel.extents = Eigen::Vector3d::Constant(width);
    return Eigen::Vector3d(BodyStencil(travel, resolution).reach() / resolution);
  };
  // A radius of 5/6 of a voxel: all of three voxels along each axis, which have room for its box.
  EXPECT_EQ(reach(BodyShape::kCylinder, 0.5, 0.3), Eigen::Vector3d::Zero());
  EXPECT_EQ(reach(BodyShape::kSphere, 0.6, 0.3), Eigen::Vector3d::Zero());
  // 2.5 voxels: the next is as far.
  EXPECT_NEAR(reach(BodyShape::kCylinder, 0.5, 0.1).x(), 0.5, 1.001e-4);
  EXPECT_NEAR(reach(BodyShape::kSphere, 0.5, 0.1).z(), 0.5, 1.001e-4);
  // 1.6 voxels: of the next the corner at 1.5 and 1.5 voxels is the nearest.
  const double room = std::hypot(1.5, 1.5) - 1.6;
  EXPECT_NEAR(reach(BodyShape::kCylinder, 0.32, 0.1).x(), 0.5 - room / std::sqrt(2.0), 1e-9);
  // Less than half a voxel: as its box.
  EXPECT_NEAR(reach(BodyShape::kCylinder, 0.06, 0.1).x(), 0.3, 1e-9);
}

// Wherever the rule says that a body fits, no voxel that is not known to be free is nearer than the margin.
TEST(BodyStencil, ReachIsSoundAnywhere) {
  const KeyBox bounds{key_at(-14, -14, -14), key_at(14, 14, 14)};
  int free = 0, only_by_reach = 0;
  for (const double resolution : {0.1, 0.15, 0.3})
    for (const TravelOptions& travel : test::bodies_in_space()) {
      Random random(static_cast<std::uint64_t>(1000 * (resolution + travel.extents.x())));
      const Lattice lattice(resolution);
      VoxelGrid grid(resolution);
      test::fill(grid, bounds, Occupancy::kFree);
      for (int i = 0; i < 60; ++i)
        grid.set(random.key_in(bounds), random.one_in(2) ? Occupancy::kOccupied : Occupancy::kUnknown);
      TravelCorridor corridor(travel, lattice, bounds);
      corridor.update({grid}, kCell);
      for (int i = 0; i < 400; ++i) {
        Eigen::Vector3d at = random.point(-9, 9) * resolution;
        if (random.one_in(3)) at[random.below(3)] = lattice.center(random.key_in(bounds).x);
        const Eigen::Vector3d to =
            random.one_in(2) ? at : Eigen::Vector3d(at + random.point(-1, 1) * resolution);
        if (!segment_is_free(corridor, lattice, at, to)) {
          only_by_reach += corridor.passable(*lattice.key(at)) ? 1 : 0;
          continue;
        }
        ++free;
        for (const double part : {0.0, 0.3, 0.7, 1.0}) {
          const Eigen::Vector3d here = at + part * (to - at);
          for_each_key(test::voxels_near(travel, lattice, here), [&](const VoxelKey& key) {
            if (grid.at(key) == Occupancy::kFree) return;
            // `reach` does not count a ten thousandth of a voxel along each axis.
            ASSERT_LE(test::depth_in(travel, here, test::cube_of(lattice, key)), 1.75e-4 * resolution)
                << here.transpose() << ", " << resolution << " m, shape " << static_cast<int>(travel.shape)
                << " of " << travel.extents.transpose() << ", margin " << travel.margin;
          });
        }
      }
    }
  EXPECT_GT(free, 3'000);
  EXPECT_GT(only_by_reach, 300);
}

}  // namespace
}  // namespace frontlux::planner
