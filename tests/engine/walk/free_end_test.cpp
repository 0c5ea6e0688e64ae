// Where rays end that nothing blocks, compared with the walk.

#include "walk/free_end.hpp"

#include "support/random.hpp"
#include "support/ray_samples.hpp"
#include "walk/walk.hpp"

#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::test {
namespace {

TEST(FreeEnd, IsWhereTheWalkEnds) {
  const VoxelGrid nothing(0.1);
  auto rays = adversarial_rays(nothing, 6000, 1);
  Random random(2);
  std::size_t left_to_the_walk = 0;
  std::array<std::size_t, 2> ends{};  // out of range, left the map
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray& ray = rays[i];
    ray.max_range = i % 10 == 0 ? -1.0 : random.uniform(0.0, i % 10 == 1 ? 300.0 : 20.0);
    const auto start = nothing.lattice().key(ray.origin);
    const Eigen::Vector3f direction = detail::normalized_as_octomap(ray.direction);
    if (!start || !detail::is_unit(direction)) continue;
    const auto end = detail::find_free_end(nothing.lattice(), ray, *start, direction);
    if (!end) {
      ++left_to_the_walk;
      continue;
    }
    const Hit walked = detail::walk_ray(nothing, ray, UnknownPolicy::kPass);
    ASSERT_EQ(walked.stop, end->stop) << i;
    ASSERT_EQ(walked.key, end->key) << i;
    ++ends[end->stop == RayStop::kOutOfRange ? 0 : 1];
  }
  EXPECT_GT(left_to_the_walk, 10U);  // edges, corners and rays along faces are among the samples
  EXPECT_GT(ends[0], 1000U);
  EXPECT_GT(ends[1], 100U);
}

// Its squares are denormal, so that castRay makes it too long by 5e-5: after 10,000 voxels that is half a
// voxel.
TEST(FreeEnd, IsThatOfTheWalkForADirectionThatUnderflows) {
  VoxelGrid grid(0.1);
  grid.set({32768, 32768, 32768}, Occupancy::kFree);
  grid.set({32800, 32800, 32800}, Occupancy::kOccupied);
  const Ray ray{{-0.719698429107666F, -2.3293895721435547F, 1.6276512145996094F},
                {2.03155255520436e-21F, -1.6853269817529837e-21F, 1.3581832089142092e-21F},
                981.1539348423099};
  EXPECT_FALSE(detail::is_unit(detail::normalized_as_octomap(ray.direction)));
  const Hit walked = detail::walk_ray(grid, ray, UnknownPolicy::kPass);
  EXPECT_EQ(walked.key, (VoxelKey{39475, 27174, 37273}));
  for (const auto& caster : {make_ray_caster(grid), make_embree_ray_caster(grid)})
    EXPECT_EQ(caster->cast(ray, UnknownPolicy::kPass).key, walked.key);
}

}  // namespace
}  // namespace frontlux::test
