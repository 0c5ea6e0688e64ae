// Which cells remain, against the ray of every cell and a flood voxel by voxel.

#include "assignment/visibility_flood.hpp"

#include "assignment/view_offsets.hpp"
#include "support/random.hpp"
#include "support/views.hpp"

#include <frontlux/ray_caster.hpp>
#include <frontlux/view_region.hpp>

namespace frontlux::planner::detail {
namespace {

using test::Random;

constexpr int kSize = 20;  // [voxels] of the map, along x and y; along z it is twice as high

struct Scene {
  VoxelGrid grid{0.5};
  std::vector<VoxelKey> cells, targets;
};

Scene random_scene(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  const int wall = 2 + random.below(8);
  const std::array<int, 3> corner = {random.one_in(2) ? 0 : 32750, 32767,
                                     random.one_in(3) ? 65536 - 2 * kSize : 7};
  const VoxelKey low = make_key(corner[0], corner[1], corner[2]);
  for_each_key({low, make_key(low.x + kSize - 1, low.y + kSize - 1, low.z + 2 * kSize - 1)},
               [&](const VoxelKey& key) {
                 if (random.one_in(wall) || (key.z - low.z) % 11 == 5) {
                   if (!random.one_in(10)) scene.grid.set(key, Occupancy::kOccupied);
                 } else if (random.one_in(2)) {
                   scene.grid.set(key, Occupancy::kFree);
                 }
                 if (random.one_in(3)) scene.cells.push_back(key);
                 if (random.one_in(600)) scene.targets.push_back(key);
               });
  return scene;
}

std::vector<FieldOfView> views() {
  return {test::lidar(6.0), test::camera(9.0), test::cone(170 * test::kDegree, 5.0)};
}

TEST(VisibilityFlood, MissesNoCellThatSeesTheTarget) {
  std::size_t seeing = 0, kept = 0, in_view = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Scene scene = random_scene(seed);
    const auto caster = make_grid_ray_caster(scene.grid);
    for (const FieldOfView& view : views()) {
      const ViewRegion region(view, scene.grid.resolution());
      const auto flood = VisibilityFlood::make(scene.grid, scene.cells, region, bounds_of(scene.targets));
      ASSERT_TRUE(flood);
      VisibilityFlood::Row row;
      for (const VoxelKey& target : scene.targets) {
        std::vector<VoxelKey> found;
        flood->cells(target, row, found);
        std::ranges::sort(found);
        ASSERT_TRUE(std::ranges::adjacent_find(found) == found.end()) << "a cell twice, seed " << seed;
        std::size_t feasible = 0;
        for (const VoxelKey& cell : scene.cells) {
          if (!view.contains_at_some_yaw(test::offset_between(target, cell, 0.5))) continue;
          ++in_view;
          const bool is_found = std::ranges::binary_search(found, cell);
          feasible += is_found ? 1 : 0;
          const bool visible = test::is_visible(*caster, {cell, target}, UnknownPolicy::kPass);
          seeing += visible ? 1 : 0;
          ASSERT_TRUE(is_found || !visible) << "seed " << seed;
        }
        ASSERT_EQ(feasible, found.size())
            << "cells that are not of the corridor or not in view, seed " << seed;
        kept += found.size();
      }
    }
  }
  EXPECT_GT(seeing, 10'000U);
  EXPECT_LT(kept, in_view * 2 / 3);
}

TEST(VisibilityFlood, FindsNothingBehindAClosedWall) {
  VoxelGrid grid(0.5);
  std::vector<VoxelKey> cells;
  for_each_key({{110, 100, 100}, {119, 119, 119}}, [&](const VoxelKey& key) {
    if (key.x == 110) return grid.set(key, Occupancy::kOccupied);
    cells.push_back(key);
  });
  const ViewRegion region(test::camera(9.0), 0.5);
  const VoxelKey target{108, 110, 110};
  const auto found_from = [&] {
    const auto flood = VisibilityFlood::make(grid, cells, region, {target, target});
    VisibilityFlood::Row row;
    std::vector<VoxelKey> found;
    flood->cells(target, row, found);
    return found;
  };
  EXPECT_TRUE(found_from().empty());
  grid.set({110, 110, 110}, Occupancy::kFree);
  const std::vector<VoxelKey> found = found_from();
  EXPECT_TRUE(std::ranges::find(found, VoxelKey{119, 110, 110}) != found.end());
}

TEST(VisibilityFlood, LeavesRegionsThatAreTooHighToOthers) {
  const Scene scene = random_scene(1);
  const ViewRegion region({FieldOfView::Shape::kPyramid, 90 * test::kDegree, 90 * test::kDegree, 50.0}, 0.5);
  ASSERT_GT(region.greatest_height(), 63);
  EXPECT_FALSE(VisibilityFlood::make(scene.grid, scene.cells, region, bounds_of(scene.targets)));
}

TEST(ViewOffsets, AreSpreadOverAllOfTheView) {
  for (const FieldOfView& view : views()) {
    const ViewRegion region(view, 0.5);
    const auto offsets = spread_offsets(region, 64);
    ASSERT_EQ(offsets.size(), 64U);
    std::array<int, 8> in_octant{};
    for (const auto& [x, y, z] : offsets) {
      ASSERT_TRUE(view.contains_at_some_yaw(Eigen::Vector3d(x, y, z) * 0.5));
      ++in_octant[static_cast<std::size_t>((x > 0 ? 1 : 0) + (y > 0 ? 2 : 0) + (z > 0 ? 4 : 0))];
    }
    for (const int count : in_octant) EXPECT_GE(count, 3);
  }
}

}  // namespace
}  // namespace frontlux::planner::detail
