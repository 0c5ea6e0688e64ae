// Distances and paths on random cells against Dijkstra's algorithm.

#include "corridor/path_distances.hpp"

#include "planner/corridor/dijkstra.hpp"
#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

// The sum of a path's steps, each of which has to be allowed.
void expect_length(const std::vector<VoxelKey>& path, const std::set<VoxelKey>& open, int stride,
                   PathMetric metric, int expected) {
  int length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const VoxelKey &from = path[i - 1], &to = path[i];
    const int step = test::length_of_step(
        open, from, {(to.x - from.x) / stride, (to.y - from.y) / stride, (to.z - from.z) / stride}, stride,
        metric);
    ASSERT_NE(step, 0);
    length += step;
  }
  ASSERT_EQ(length, expected);
}

TEST(PathDistances, EqualDijkstrasAlgorithm) {
  std::size_t cells = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const PathMetric metric = seed % 3 == 0 ? PathMetric::kSteps : PathMetric::kEuclidean;
    const int stride = 1 + random.below(3), gaps = 2 + random.below(8), size_z = seed % 4 == 0 ? 1 : 12;
    const CellFrame frame{make_key(random.one_in(2) ? 0 : 32000, 500, 65535 - 11 * stride),
                          {1 + random.below(12), 1 + random.below(12), size_z},
                          stride};
    std::vector<VoxelKey> all;
    std::set<VoxelKey> open;
    for (int x = 0; x < frame.size[0]; ++x)
      for (int y = 0; y < frame.size[1]; ++y)
        for (int z = 0; z < frame.size[2]; ++z) {
          all.push_back(frame.key(x, y, z));
          if (!random.one_in(gaps)) open.insert(all.back());
        }
    const VoxelKey start = random.pick(all);
    PathDistances distances(frame, metric);
    distances.reset([&](const VoxelKey& key) { return open.contains(key); });
    distances.spread(start);
    const auto expected = test::dijkstra(open, start, stride, metric);
    std::vector<VoxelKey> reached;
    distances.reached(reached);
    ASSERT_EQ(reached.size(), expected.size()) << "seed " << seed;
    cells += reached.size();
    auto next = reached.begin();
    for (const VoxelKey& key : all) {
      ASSERT_EQ(distances.open(key), open.contains(key));
      const std::vector<VoxelKey> path = distances.path_to(key);
      const auto found = expected.find(key);
      ASSERT_EQ(path.empty(), found == expected.end());
      ASSERT_EQ(distances.distance(key).has_value(), found != expected.end());
      if (found == expected.end()) continue;
      ASSERT_EQ(*next++, key);
      ASSERT_EQ(distances.distance(key), found->second / 985.0);
      ASSERT_EQ(path.front(), start);
      ASSERT_EQ(path.back(), key);
      expect_length(path, open, stride, metric, found->second);
      if (testing::Test::HasFatalFailure()) return;
    }
    EXPECT_FALSE(distances.open(make_key(500, 499, 500)));
    EXPECT_EQ(distances.open(make_key(frame.first.x, 500, frame.first.z + 1)),
              open.contains(make_key(frame.first.x, 500, frame.first.z + 1)));  // between cells, or one
  }
  EXPECT_GT(cells, 4'000U);
  for (const int axes : {1, 2, 3})
    EXPECT_NEAR(test::kStepLengths.at(static_cast<std::size_t>(axes)) / 985.0, std::sqrt(axes), 5e-5 * axes);
}

}  // namespace
}  // namespace frontlux::planner::detail
