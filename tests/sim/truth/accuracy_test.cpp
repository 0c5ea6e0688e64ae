#include "sim/mesh/box_mesh.hpp"
#include "support/complaint.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/sim/accuracy.hpp>

namespace frontlux::sim {
namespace {

using frontlux::test::key_at;

// Free voxels from 1 to 18 along x and y and 1 to 8 along z, surface voxels around them; a pane without
// thickness on the face between the voxels 9 and 10 along x, from y = 10 on.
GroundTruth room_with_a_pane() {
  World world{"room", {}, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2, 2, 1)}, std::nullopt};
  test::add_box(world.mesh, {Eigen::Vector3f(0.05F, 0.05F, 0.05F), Eigen::Vector3f(1.95F, 1.95F, 0.95F)});
  test::add_quad(world.mesh, {1, 1, 0}, {1, 2, 0}, {1, 2, 1}, {1, 1, 1});
  return {world, 0.1, {0.55, 0.55, 0.55}};
}

VoxelGrid perfect_map(const GroundTruth& truth) {
  VoxelGrid map(0.1);
  for_each_key(truth.bounds(), [&](const VoxelKey& key) {
    if (truth.at(key) != Truth::kHidden)
      map.set(key, truth.at(key) == Truth::kFree ? Occupancy::kFree : Occupancy::kOccupied);
  });
  return map;
}

TEST(Accuracy, OfAPerfectMap) {
  const GroundTruth truth = room_with_a_pane();
  const Accuracy accuracy = measure_accuracy(truth, perfect_map(truth));
  EXPECT_EQ(accuracy.free, 18U * 18 * 8);
  EXPECT_EQ(accuracy.surface, truth.surface_voxels());
  EXPECT_GT(accuracy.surface, 1000U);
  EXPECT_EQ(accuracy, (Accuracy{accuracy.free, 0, accuracy.surface, 0, accuracy.surface, accuracy.surface}));
  EXPECT_EQ(accuracy.surface_part(), 1.0);
  EXPECT_EQ(accuracy.false_free_part(), 0.0);
  EXPECT_EQ(measure_accuracy(truth, VoxelGrid(0.1)), (Accuracy{0, 0, 0, 0, truth.surface_voxels(), 0}));
}

TEST(Accuracy, CountsEachKindOfError) {
  const GroundTruth truth = room_with_a_pane();
  VoxelGrid map = perfect_map(truth);
  const Accuracy perfect = measure_accuracy(truth, map);
  ASSERT_EQ(truth.at(key_at(5, 5, 0)), Truth::kSurface);
  map.set(key_at(5, 5, 0), Occupancy::kFree);
  map.set(key_at(6, 5, 0), Occupancy::kUnknown);
  map.set(key_at(5, 5, 5), Occupancy::kOccupied);    // in the middle of nothing
  map.set(key_at(10, 15, 5), Occupancy::kOccupied);  // behind the pane, rightly
  map.set(key_at(9, 15, 5), Occupancy::kOccupied);   // before it: as right, from the other side
  map.set(key_at(12, 15, 5), Occupancy::kUnknown);
  const Accuracy accuracy = measure_accuracy(truth, map);
  EXPECT_EQ(accuracy, (Accuracy{perfect.free - 4 + 1, 1, perfect.occupied - 2 + 3, 1, perfect.surface,
                                perfect.surface - 2}));
  EXPECT_EQ(accuracy.false_occupied_part(), 1.0 / static_cast<double>(accuracy.occupied));
}

// What lies beyond the world's bounds does not count.
TEST(Accuracy, LooksWithinTheBoundsOnly) {
  const GroundTruth truth = room_with_a_pane();
  VoxelGrid map(0.1);
  map.fill({key_at(32, 32, 32), 5}, Occupancy::kFree);
  map.set(key_at(-3, 5, 5), Occupancy::kOccupied);
  EXPECT_EQ(measure_accuracy(truth, map), (Accuracy{0, 0, 0, 0, truth.surface_voxels(), 0}));
  EXPECT_REFUSED(static_cast<void>(measure_accuracy(truth, VoxelGrid(0.2))));
}

}  // namespace
}  // namespace frontlux::sim
