// The index of targets and its order against their definitions.

#include "view/target_index.hpp"

#include "support/random.hpp"

namespace frontlux::test {
namespace {

using detail::TargetIndex;

const KeyBox kBox{{32768, 32768, 0}, {32917, 32917, 79}};

TEST(CellCode, SortsByCubesAndIsReversible) {
  Random random(2);
  for (int i = 0; i < 10'000; ++i) {
    const VoxelKey a = random.key_in(kAllVoxels);
    const std::uint64_t code = detail::cell_code(a);
    ASSERT_EQ(detail::cell_of_code(code), a);
    ASSERT_EQ(detail::cube_of_code(code), cube(make_key(a.x & ~7, a.y & ~7, a.z & ~7), 8));
    const VoxelKey region = detail::cell_of_code(code >> detail::kRegionCode << detail::kRegionCode);
    ASSERT_EQ(region, make_key(a.x & ~63, a.y & ~63, a.z & ~63));
  }
}

TEST(TargetIndex, ListsAllThatIsInView) {
  Random random(3);
  std::vector<VoxelKey> targets{{0, 0, 0}, {65535, 65535, 65535}};
  for (int i = 0; i < 4000; ++i) targets.push_back(random.key_in(kBox));
  targets.push_back(targets.front());
  const TargetIndex index(targets);
  EXPECT_EQ(index.codes().size(), std::set<VoxelKey>(targets.begin(), targets.end()).size());
  std::uint32_t next = 0;
  for (const TargetIndex::Cube& cube : index.cubes()) {
    ASSERT_EQ(cube.begin, next);
    next = cube.end;
    for (std::uint32_t t = cube.begin; t < cube.end; ++t)
      ASSERT_TRUE(cube.box.contains(detail::cell_of_code(index.codes()[t])));
  }
  EXPECT_EQ(next, index.codes().size());

  const ViewRegion view({FieldOfView::Shape::kSpinning, 0.0, 1.2, 6.0}, 0.3);
  std::vector<std::uint32_t> cubes;
  for (int i = 0; i < 100; ++i) {
    const VoxelKey from = random.key_in(kBox);
    index.list_cubes(view, {from, from}, cubes);
    EXPECT_TRUE(std::is_sorted(cubes.begin(), cubes.end()));
    EXPECT_LT(cubes.size(), index.cubes().size());
    std::set<VoxelKey> listed;
    for (const std::uint32_t c : cubes)
      for (std::uint32_t t = index.cubes()[c].begin; t < index.cubes()[c].end; ++t)
        listed.insert(detail::cell_of_code(index.codes()[t]));
    for (const VoxelKey& to : targets) ASSERT_TRUE(!view.contains(from, to) || listed.contains(to));
  }
}

}  // namespace
}  // namespace frontlux::test
