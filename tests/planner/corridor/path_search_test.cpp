// Paths found one at a time against Dijkstra's algorithm from cell to cell.
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

TEST(PathSearch, FindsShortestPaths) {
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

// Beyond what a corridor knows near by: where the straight path is closed, by those that are left.
TEST(TravelCorridor, SearchesFarPaths) {
  Random random(62);
  const KeyBox hall{test::key_at(0, 0, 0), test::key_at(99, 8, 1)};
  using Through = std::function<bool(const VoxelKey&)>;
  const Through anywhere = [](const VoxelKey&) { return true; };
  std::size_t found = 0, none = 0, longer = 0;
  for (int round = 0; round < 5; ++round) {
    VoxelGrid grid(0.2);
    test::fill(grid, hall, Occupancy::kFree);
    for (int i = 0; i < 300; ++i) grid.set(random.key_in(hall), Occupancy::kOccupied);
    TravelOptions options;
    options.extents = {0.2, 0.2, 0.2};
    options.min_height = -100.0;
    options.metric = random.one_in(3) ? PathMetric::kSteps : PathMetric::kEuclidean;
    TravelCorridor corridor(options, grid.lattice(), hall);
    const VoxelKey robot = test::key_at(2, 4, 0);
    grid.set(robot, Occupancy::kFree);
    corridor.update({grid}, robot, CorridorExtent::kNearby);
    const KeyBox slab{random.key_in({test::key_at(20, 0, 0), test::key_at(40, 3, 0)}),
                      test::key_at(45, 6, 1)},
        wall{test::key_at(70, 0, 0), test::key_at(70, 8, 1)};
    const Through beside = [&](const VoxelKey& key) { return !slab.contains(key); };
    const Through before_wall = [&](const VoxelKey& key) { return !wall.contains(key); };
    std::map<VoxelKey, int> shortest;
    for (const Through& through : {anywhere, beside, before_wall}) {
      std::set<VoxelKey> open;
      for_each_key(hall, [&](const VoxelKey& key) {
        if (grid.at(key) == Occupancy::kFree && through(key)) open.insert(key);
      });
      const auto expected = test::dijkstra(open, robot, 1, options.metric);
      if (shortest.empty()) shortest = expected;
      for (int i = 0; i < 20; ++i) {
        const VoxelKey goal = random.key_in({test::key_at(50, 0, 0), hall.max});
        ASSERT_FALSE(corridor.contains(goal)) << "it is near";
        const bool is_there = expected.contains(goal);
        ASSERT_EQ(corridor.find_path(goal, through), is_there);
        const std::vector<VoxelKey> path = corridor.path_to(goal);
        ASSERT_EQ(path.empty(), !is_there);
        ++(is_there ? found : none);
        if (!is_there) continue;
        ASSERT_EQ(path.front(), robot);
        ASSERT_EQ(path.back(), goal);
        ASSERT_EQ(length_of(path, open, options.metric, 1), expected.at(goal));
        longer += expected.at(goal) > shortest.at(goal) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(found, 100U);
  EXPECT_GT(none, 50U);
  EXPECT_GT(longer, 30U);
}

}  // namespace
}  // namespace frontlux::planner::detail
