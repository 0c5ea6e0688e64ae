#include "support/maps.hpp"
#include "support/random.hpp"

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

}  // namespace
}  // namespace frontlux::test
