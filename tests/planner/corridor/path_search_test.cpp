// Ways found one at a time against Dijkstra's algorithm from cell to cell.
#include "corridor/path_search.hpp"

#include "planner/corridor/dijkstra.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

// In the units of `kMoveLengths`; -1 if one of its steps is not allowed.
int length_of(const std::vector<VoxelKey>& path, const std::set<VoxelKey>& open, PathMetric metric,
              int stride) {
  int length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const VoxelKey &a = path[i - 1], &b = path[i];
    const std::array<int, 3> step = {(b.x - a.x) / stride, (b.y - a.y) / stride, (b.z - a.z) / stride};
    const int added = test::length_of_step(open, a, step, stride, metric);
    if (added == 0) return -1;
    length += added;
  }
  return length;
}

TEST(PathSearch, FindsShortestWays) {
  Random random(61);
  std::size_t found = 0, none = 0;
  for (int round = 0; round < 60; ++round) {
    CellFrame frame;
    frame.first = test::key_at(-5, 3, 0);
    frame.size = {4 + random.below(12), 4 + random.below(12), random.one_in(3) ? 1 : 2 + random.below(6)};
    frame.stride = random.one_in(4) ? 4 : 1;
    const PathMetric metric = random.one_in(3) ? PathMetric::kSteps : PathMetric::kEuclidean;
    std::set<VoxelKey> open;
    std::vector<VoxelKey> cells;
    const int rare = 2 + random.below(4);
    for (int x = 0; x < frame.size[0]; ++x)
      for (int y = 0; y < frame.size[1]; ++y)
        for (int z = 0; z < frame.size[2]; ++z) {
          cells.push_back(frame.key(x, y, z));
          if (!random.one_in(rare)) open.insert(cells.back());
        }
    const VoxelKey start = random.pick(cells);
    const auto expected = test::dijkstra(open, start, frame.stride, metric);
    for (int i = 0; i < 20; ++i) {
      const VoxelKey goal = random.pick(cells);
      const auto path =
          shortest_path(frame, metric, start, goal, [&](const VoxelKey& key) { return open.contains(key); });
      const auto length = expected.find(goal);
      ASSERT_EQ(path.empty(), length == expected.end());
      if (path.empty()) {
        ++none;
        continue;
      }
      ++found;
      ASSERT_EQ(path.front(), start);
      ASSERT_EQ(path.back(), goal);
      ASSERT_EQ(length_of(path, open, metric, frame.stride), length->second);
    }
  }
  EXPECT_GT(found, 300U);
  EXPECT_GT(none, 100U);
}

TEST(PathSearch, LeadsNowhereOutsideOfTheFrame) {
  const CellFrame frame{test::key_at(0, 0, 0), {5, 5, 5}};
  const auto everywhere = [](const VoxelKey&) { return true; };
  const auto find = [&](const VoxelKey& from, const VoxelKey& to) {
    return shortest_path(frame, PathMetric::kEuclidean, from, to, everywhere);
  };
  EXPECT_EQ(find(test::key_at(0, 0, 0), test::key_at(4, 4, 4)).size(), 5U);
  EXPECT_TRUE(find(test::key_at(0, 0, 0), test::key_at(5, 4, 4)).empty());
  EXPECT_TRUE(find(test::key_at(-1, 0, 0), test::key_at(4, 4, 4)).empty());
}

}  // namespace
}  // namespace frontlux::planner::detail
