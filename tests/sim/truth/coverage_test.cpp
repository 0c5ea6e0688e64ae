// Against counting every voxel of the bounds.

#include "sim/mesh/box_mesh.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/sim/coverage.hpp>

namespace frontlux::sim {
namespace {

GroundTruth room_with_a_vault() {
  World world{"room", {}, {Eigen::Vector3d(-1.5, -3, 0), Eigen::Vector3d(4.5, 3, 3)}, std::nullopt};
  test::add_box(world.mesh, {Eigen::Vector3f(-1.4F, -2.9F, 0.05F), Eigen::Vector3f(4.4F, 2.9F, 2.95F)});
  test::add_box(world.mesh, {Eigen::Vector3f(1, 1, 0.6F), Eigen::Vector3f(3.4F, 2.2F, 2)});
  return {world, 0.1, {0, 0, 1}};
}

Coverage counted(const GroundTruth& truth, const VoxelGrid& grid) {
  Coverage coverage;
  for_each_key(truth.bounds(), [&](const VoxelKey& key) {
    const bool known = grid.at(key) != Occupancy::kUnknown;
    ++coverage.bounding;
    coverage.known_bounding += known ? 1 : 0;
    if (truth.at(key) == Truth::kHidden) return;
    ++coverage.observable;
    coverage.known_observable += known ? 1 : 0;
  });
  return coverage;
}

// Single voxels and blocks of any size, within the bounds and around them.
void scribble(VoxelGrid& grid, frontlux::test::Random& random, int strokes) {
  for (int i = 0; i < strokes; ++i) {
    const VoxelKey low = make_key(Lattice::kOrigin - 50, Lattice::kOrigin - 50, Lattice::kOrigin - 50);
    grid.fill(random.block_in(cube(low, 120), random.one_in(3) ? random.below(6) : 0), random.state());
  }
}

TEST(Coverage, IsMeasuredAsCounted) {
  const GroundTruth truth = room_with_a_vault();
  VoxelGrid grid(0.1);
  Coverage measured = measure(truth, grid);
  EXPECT_EQ(measured, (Coverage{0, truth.observable_voxels(), 0, truth.bounding_voxels()}));
  frontlux::test::Random random(1);
  for (int round = 0; round < 20; ++round) {
    scribble(grid, random, 200);
    measured = measure(truth, grid);
    ASSERT_EQ(measured, counted(truth, grid)) << round;
  }
  EXPECT_GT(measured.known_observable, 10'000U);
  EXPECT_LT(measured.of_observable(), 1.0);
}

TEST(Coverage, FullMapsCoverAll) {
  const GroundTruth truth = room_with_a_vault();
  VoxelGrid grid(0.1);
  for_each_key(truth.bounds(), [&](const VoxelKey& key) {
    if (truth.contains(key))
      grid.set(key, truth.at(key) == Truth::kFree ? Occupancy::kFree : Occupancy::kOccupied);
  });
  const Coverage coverage = measure(truth, grid);
  EXPECT_EQ(coverage.of_observable(), 1.0);
  EXPECT_EQ(coverage.known_bounding, truth.observable_voxels());
  grid.fill({{0, 0, 0}, 16}, Occupancy::kFree);
  EXPECT_EQ(measure(truth, grid).of_bounding(), 1.0);
}

TEST(Coverage, RefusesAnotherResolution) { EXPECT_REFUSED(measure(room_with_a_vault(), VoxelGrid(0.2))); }

}  // namespace
}  // namespace frontlux::sim
