// Where rays end that nothing blocks, compared with the walk.

#include "walk/free_end.hpp"

#include "support/random.hpp"
#include "support/ray_samples.hpp"
#include "walk/walk.hpp"

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

}  // namespace
}  // namespace frontlux::test
