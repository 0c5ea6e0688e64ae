#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/random_view.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/visible_pairs.hpp>

namespace frontlux::planner {
namespace {

using test::Random;

std::vector<VisiblePair> listed(const VisiblePairs& pairs) {
  std::vector<VisiblePair> list;
  for (std::uint32_t i = 0; i < pairs.viewpoints(); ++i)
    for (const std::uint32_t j : pairs.frontiers_of(i)) list.push_back({i, j});
  return list;
}

TEST(VisiblePairs, AgreeWithOneRayAtATime) {
  Random random(1);
  std::size_t found = 0, blocked = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    // Every third voxel free would block nearly all: clear most of it.
    VoxelGrid grid(0.3);
    const KeyBox box{{32768, 32768, 32768}, {32791, 32791, 32779}};
    for_each_key(box, [&](const VoxelKey& key) {
      grid.set(key, random.one_in(30)   ? Occupancy::kOccupied
                    : random.one_in(30) ? Occupancy::kUnknown
                                        : Occupancy::kFree);
    });
    std::vector<VoxelKey> frontiers;
    for (int j = 0; j < 200; ++j) frontiers.push_back(random.key_in(box));
    test::sort(frontiers);
    std::vector<Pose> path;
    for (int i = 0; i < 6; ++i)
      path.push_back({{random.uniform(0, 7), random.uniform(0, 7), random.uniform(0, 3.5)}, 0.0});
    const FieldOfView view{FieldOfView::Shape::kPyramid, 1.5, 1.2, 4.0};

    const auto walk = make_grid_ray_caster(grid), fast = make_ray_caster(grid);
    std::vector<VisiblePair> expected;
    for (std::uint32_t i = 0; i < path.size(); ++i)
      for (std::uint32_t j = 0; j < frontiers.size(); ++j) {
        const Eigen::Vector3d center = grid.lattice().exact_center(frontiers[j]);
        if (!view.contains_at_some_yaw(center - path[i].position)) continue;
        const Segment segment{path[i].position.cast<float>(), center.cast<float>()};
        const bool visible = test::is_visible(*walk, segment, UnknownPolicy::kBlock);
        if (visible) expected.push_back({i, j});
        blocked += visible ? 0U : 1U;
      }
    found += expected.size();
    EXPECT_EQ(listed(visible_pairs(*walk, grid, path, frontiers, view)), expected);
    EXPECT_EQ(listed(visible_pairs(*fast, grid, path, frontiers, view)), expected);
  }
  EXPECT_GT(found, 500U);
  EXPECT_GT(blocked, 500U);
}

TEST(VisiblePairs, UnknownAndOccupiedBlockButNotTheTarget) {
  const auto key = [](int x) { return test::key_at(x, 0, 0); };
  VoxelGrid grid(1.0);
  for (int x = 0; x < 6; ++x) grid.set(key(x), Occupancy::kFree);
  const std::vector<Pose> path{{{0.5, 0.5, 0.5}, 3.0}};
  const std::vector<VoxelKey> frontiers{key(6), key(7), key(3)};  // unknown, behind it, free
  const auto seen = [&] {
    return listed(visible_pairs(*make_grid_ray_caster(grid), grid, path, frontiers, test::camera()));
  };
  EXPECT_EQ(seen(), (std::vector<VisiblePair>{{0, 0}, {0, 2}}));
  grid.set(key(2), Occupancy::kOccupied);
  EXPECT_EQ(seen(), (std::vector<VisiblePair>{}));
}

TEST(VisiblePairs, AreSortedByViewpointAndFrontier) {
  Random random(2);
  auto scene = test::random_scene(random, 7, 50, 0.3);
  std::reverse(scene.list.begin(), scene.list.end());
  const VisiblePairs pairs = scene.pairs();
  std::sort(scene.list.begin(), scene.list.end());
  EXPECT_EQ(listed(pairs), scene.list);
  EXPECT_EQ(pairs.size(), scene.list.size());
  EXPECT_EQ(pairs.frontiers(), 50U);
}

TEST(VisiblePairs, RefusesWhatCannotBe) {
  const std::vector<VisiblePair> twice{{0, 1}, {1, 1}, {0, 1}}, outside{{2, 0}}, beyond{{0, 3}};
  for (const auto& list : {twice, outside, beyond}) EXPECT_REFUSED(VisiblePairs(2, 3, list));
  const VoxelGrid grid(0.3);
  const auto caster = make_grid_ray_caster(grid);
  std::vector<Pose> path(3);
  path[1].position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_REFUSED(visible_pairs(*caster, grid, path, {}, test::camera()));
  path[1] = {{0, 0, 0}, std::numeric_limits<double>::infinity()};
  EXPECT_REFUSED(visible_pairs(*caster, grid, path, {}, test::camera()));
  path[1] = {};
  EXPECT_EQ(visible_pairs(*caster, grid, path, {}, test::camera()).size(), 0U);
  EXPECT_REFUSED(visible_pairs(*caster, grid, path, {}, {}));
}

}  // namespace
}  // namespace frontlux::planner
