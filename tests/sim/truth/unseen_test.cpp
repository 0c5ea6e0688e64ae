// Rooms in which it is plain what a robot can see.
#include "sim/mesh/box_mesh.hpp"
#include "support/complaint.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/sim/unseen.hpp>

namespace frontlux::sim {
namespace {

using Eigen::Vector3d, Eigen::Vector3f;

constexpr double kResolution = 0.1;
const planner::Pose kStart{{1.05, 3.05, 1.55}, 0.0};

// 6 x 6 x 3 m, with a wall across it that leaves a gap of this width over its whole height.
World divided_room(float gap) {
  World world{"divided room", {}, {Vector3d(0, 0, 0), Vector3d(6.2, 6.2, 3.2)}, std::nullopt};
  test::add_box(world.mesh, {Vector3f(0.05F, 0.05F, 0.05F), Vector3f(6.15F, 6.15F, 3.15F)});
  test::add_box(world.mesh, {Vector3f(3.05F, 0.05F, 0.05F), Vector3f(3.25F, 3.05F - gap / 2, 3.15F)});
  test::add_box(world.mesh, {Vector3f(3.05F, 3.05F + gap / 2, 0.05F), Vector3f(3.25F, 6.15F, 3.15F)});
  return world;
}

// The paper's UAV, which sees 10 m far, as large as told.
planner::Robot robot(double width) {
  planner::Robot robot = planner::uav();
  robot.travel.extents = Vector3d::Constant(width);
  robot.travel.min_height = width / 2;
  return robot;
}

Unseen explain(float gap, double width, const VoxelGrid& map) {
  const GroundTruth truth(divided_room(gap), kResolution, kStart.position);
  return explain_unseen(truth, map, {{robot(width)}}, {{kStart}});
}

double sum(const Unseen& unseen) { return unseen.in_view + unseen.narrow + unseen.hidden; }

TEST(Unseen, IsNothingOfAWholeMap) {
  VoxelGrid map(kResolution);
  const GroundTruth truth(divided_room(0.9F), kResolution, kStart.position);
  for_each_key(truth.bounds(), [&](const VoxelKey& key) { map.set(key, Occupancy::kFree); });
  EXPECT_EQ(sum(explain(0.9F, 0.5, map)), 0.0);
}

TEST(Unseen, CouldAllHaveBeenSeenWhereTheRobotFits) {
  const Unseen unseen = explain(0.9F, 0.5, VoxelGrid(kResolution));
  EXPECT_NEAR(sum(unseen), 1.0, 1e-9);
  EXPECT_GT(unseen.in_view, 0.97) << unseen.narrow << " narrow, " << unseen.hidden << " hidden";
}

TEST(Unseen, IsBehindWhatIsTooNarrow) {
  const Unseen wide = explain(0.6F, 0.5, VoxelGrid(kResolution));
  const Unseen narrow = explain(0.6F, 0.9, VoxelGrid(kResolution));
  EXPECT_LT(wide.narrow, 0.03);
  EXPECT_NEAR(sum(narrow), 1.0, 1e-9);
  // Through the gap it sees a part of the other half, whose corners it does not see.
  EXPECT_GT(narrow.narrow, 0.1);
  EXPECT_LT(narrow.narrow, 0.5);
}

// A wall without thickness on a face of voxels, which a body all but touches from either side.
TEST(Unseen, IsInViewOfARobotThatStartsBesideAWall) {
  World world{"screen", {}, {Vector3d(0, 0, 0), Vector3d(6.2, 6.2, 3.2)}, std::nullopt};
  test::add_box(world.mesh, {Vector3f(0.05F, 0.05F, 0.05F), Vector3f(6.15F, 6.15F, 3.15F)});
  test::add_quad(world.mesh, {3.1F, 0.05F, 0.05F}, {3.1F, 3.05F, 0.05F}, {3.1F, 3.05F, 3.15F},
                 {3.1F, 0.05F, 3.15F});
  const GroundTruth truth(world, kResolution, kStart.position);
  for (const double x : {2.85, 3.35, 3.75}) {
    const Unseen unseen = explain_unseen(truth, VoxelGrid(kResolution), {{robot(0.5)}},
                                         {{planner::Pose{{x, 1.55, 1.55}, 0.0}}});
    EXPECT_GT(unseen.in_view, 0.97) << x << ": " << unseen.narrow << " narrow, " << unseen.hidden
                                    << " hidden";
  }
}

// A margin of which the room at the start alone would be 10^9 voxels.
TEST(Unseen, LooksAtTheWorldOnlyHoweverWideAMargin) {
  planner::Robot wide = robot(0.5);
  wide.travel.margin = 100.0;
  const GroundTruth truth(divided_room(0.9F), kResolution, kStart.position);
  const Unseen unseen = explain_unseen(truth, VoxelGrid(kResolution), {{wide}}, {{kStart}});
  EXPECT_EQ(unseen.in_view, 0.0);
  EXPECT_NEAR(sum(unseen), 1.0, 1e-9);
}

// Only what the map does not know counts.
TEST(Unseen, CountsWhatTheMapLacks) {
  VoxelGrid map(kResolution);
  const GroundTruth truth(divided_room(0.6F), kResolution, kStart.position);
  std::uint64_t known = 0;
  for_each_key(truth.bounds(), [&](const VoxelKey& key) {
    if (truth.lattice().center(key.x) > 2.0) return;
    map.set(key, Occupancy::kFree);
    known += truth.contains(key) ? 1 : 0;
  });
  const double left = 1.0 - static_cast<double>(known) / static_cast<double>(truth.observable_voxels());
  EXPECT_NEAR(sum(explain(0.6F, 0.9, map)), left, 1e-9);
}

TEST(Unseen, RefusesAnotherResolution) {
  frontlux::test::expect_complaint<std::invalid_argument>(
      [] { static_cast<void>(explain(0.6F, 0.5, VoxelGrid(0.2))); }, {"0.2", "0.1"});
}

}  // namespace
}  // namespace frontlux::sim
