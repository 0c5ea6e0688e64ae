#include "support/maps.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/ray_caster.hpp>

#include <vector>

namespace frontlux::test {
namespace {

// Few are walked through the grid, many ask the boxes, which are made then.
TEST(FastRayCaster, AnswersFewAndManySegmentsBetweenPointsAlike) {
  constexpr std::size_t kBatch = 1000;
  VoxelGrid grid = make_voxel_grid(*make_random_tree(4, 0.25));
  Random random(5);
  for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass}) {
    const auto caster = make_ray_caster(grid);
    for (int update = 0; update < 2; ++update) {
      const auto reference = make_grid_ray_caster(grid);
      std::size_t batches = 0, visible = 0;
      const std::size_t bytes = caster->memory_bytes();
      for (; caster->memory_bytes() == bytes && batches < 100; ++batches) {
        std::vector<Segment> segments;
        for (std::size_t i = 0; i < kBatch; ++i)
          segments.push_back({random.point(-3, 3).cast<float>(), random.point(-3, 3).cast<float>()});
        std::vector<std::uint8_t> expected(kBatch), answers(kBatch);
        reference->visible(segments, expected, unknown);
        caster->visible(segments, answers, unknown);
        ASSERT_EQ(answers, expected);
        visible += static_cast<std::size_t>(std::ranges::count(answers, 1));
      }
      if (update == 0) {
        EXPECT_GT(batches, 5U);
        EXPECT_LT(batches, 100U) << "boxes are made";
      }
      EXPECT_GT(visible, 0U);
      for (int i = 0; i < 200; ++i)
        grid.set(*grid.lattice().key(Eigen::Vector3f(random.point(-3, 3).cast<float>())), Occupancy::kFree);
      caster->update(grid);
    }
  }
}

// Rays that leave the table: one changed voxel is no reason to make the boxes anew for a few of them.
TEST(FastRayCaster, AnswersFewAndManyLongRaysAlike) {
  constexpr std::size_t kBatch = 1000;
  constexpr KeyBox kHall{{32000, 32768, 32768}, {32470, 32790, 32778}};
  VoxelGrid grid(0.1);
  fill(grid, kHall, Occupancy::kFree);
  Random random(6);
  for (int i = 0; i < 100; ++i) grid.set(random.key_in(kHall), Occupancy::kOccupied);
  const auto middle = [&](const VoxelKey& key) { return grid.lattice().center(key); };
  const auto caster = make_ray_caster(grid);
  for (int update = 0; update < 2; ++update) {
    const auto reference = make_grid_ray_caster(grid);
    std::size_t batches = 0, long_ones = 0;
    const std::size_t bytes = caster->memory_bytes();
    const std::size_t most = update == 0 ? 60 : 3;
    for (; caster->memory_bytes() == bytes && batches < most; ++batches) {
      std::vector<Ray> rays;
      for (std::size_t i = 0; i < kBatch; ++i) {
        VoxelKey from = random.key_in(kHall), to = random.key_in(kHall);
        from.x = static_cast<std::uint16_t>(32000 + random.below(10));
        to.x = static_cast<std::uint16_t>(32470 - random.below(10));
        rays.push_back({middle(from), middle(to) - middle(from)});
      }
      std::vector<Hit> expected(kBatch), hits(kBatch);
      reference->cast(rays, expected, UnknownPolicy::kBlock);
      caster->cast(rays, hits, UnknownPolicy::kBlock);
      for (std::size_t i = 0; i < kBatch; ++i) {
        ASSERT_EQ(hits[i].stop, expected[i].stop);
        ASSERT_EQ(hits[i].key, expected[i].key);
        long_ones += hits[i].distance > 40.0F ? 1 : 0;
        Eigen::Vector3f end;
        ASSERT_EQ(caster->cast(rays[i], UnknownPolicy::kBlock, end), expected[i].stop);
        ASSERT_EQ(end, expected[i].end);
      }
    }
    if (update == 0) {
      EXPECT_GT(batches, 5U);
      EXPECT_LT(batches, 60U) << "boxes are made";
    }
    EXPECT_GT(long_ones, 1'000U);
    grid.set(random.key_in(kHall), Occupancy::kOccupied);
    caster->update(grid);
  }
}

}  // namespace
}  // namespace frontlux::test
