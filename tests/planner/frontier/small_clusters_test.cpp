#include "frontier/small_clusters.hpp"

#include "frontier/abandoned_frontiers.hpp"
#include "support/random.hpp"

namespace frontlux::planner {
namespace {

using test::Random;

// Size of the cluster of each voxel, by a flood fill that visits all of it.
std::map<VoxelKey, std::size_t> cluster_sizes(std::span<const VoxelKey> frontiers) {
  std::set<VoxelKey> left(frontiers.begin(), frontiers.end());
  std::map<VoxelKey, std::size_t> sizes;
  while (!left.empty()) {
    std::vector<VoxelKey> cluster = {*left.begin()};
    left.erase(left.begin());
    for (std::size_t i = 0; i < cluster.size(); ++i)
      for (auto next = left.begin(); next != left.end();) {
        const bool near = grown({cluster[i], cluster[i]}, 1).contains(*next);
        if (near) cluster.push_back(*next);
        next = near ? left.erase(next) : std::next(next);
      }
    for (const VoxelKey& key : cluster) sizes[key] = cluster.size();
  }
  return sizes;
}

TEST(SmallClusters, AreThoseThatAFloodFillFinds) {
  int small = 0, large = 0;
  for (const int origin : {0, 32700, 0xFFFF - 19})
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      Random random(seed);
      const KeyBox box = cube(make_key(origin, origin, origin), 20);
      VoxelGrid grid(0.3);
      for (int i = 0; i < 30; ++i)
        grid.set(random.key_in(box), random.one_in(3) ? Occupancy::kOccupied : Occupancy::kFree);
      const FrontierSet frontiers(grid, kAllVoxels);
      const auto sizes = cluster_sizes(frontiers.keys());
      std::vector<VoxelKey> some;
      for (const VoxelKey& key : frontiers.keys())
        if (!random.one_in(4)) some.push_back(key);  // clusters are those of all, whichever are asked for
      for (const int size : {-1, 1, 4, 6, 7, 12, 1000}) {
        std::vector<VoxelKey> expected;
        for (const VoxelKey& key : some)
          if (static_cast<int>(sizes.at(key)) >= size) expected.push_back(key);
        EXPECT_EQ(detail::in_large_clusters(frontiers, some, size), expected) << size;
        if (size == 7) {
          large += static_cast<int>(expected.size());
          small += static_cast<int>(some.size() - expected.size());
        }
      }
    }
  EXPECT_GT(small, 50);
  EXPECT_GT(large, 50);
}

TEST(AbandonedFrontiers, AreAbandonedAfterSomeVisits) {
  for (const int visits : {1, 2, 5}) {
    Random random(static_cast<std::uint64_t>(visits));
    detail::AbandonedFrontiers abandoned(visits);
    std::map<VoxelKey, int> count;
    std::vector<VoxelKey> all;
    for (std::uint16_t i = 0; i < 50; ++i) all.push_back({i, 7, 9});
    for (int round = 0; round < 12; ++round) {
      std::vector<VoxelKey> rest;
      for (const VoxelKey& key : all)
        if (count[key] < visits) rest.push_back(key);
      EXPECT_EQ(abandoned.without_abandoned(all), rest);
      std::vector<VoxelKey> seen;
      for (const VoxelKey& key : all)
        if (random.one_in(3)) seen.push_back(key);
      abandoned.visited(seen);
      for (const VoxelKey& key : seen) ++count[key];
    }
  }
}

TEST(AbandonedFrontiers, AreAbandonedAfterRobotsHaveTurnedBackFiveTimes) {
  detail::AbandonedFrontiers abandoned(1);
  const std::vector<VoxelKey> all = {{1, 7, 9}, {2, 7, 9}, {3, 7, 9}};
  const std::vector<VoxelKey> some = {all[0], all[2]};
  for (int times = 0; times < 4; ++times) abandoned.turned_back(some);
  EXPECT_EQ(abandoned.without_abandoned(all), all);
  abandoned.visited(std::vector{all[2]});
  EXPECT_EQ(abandoned.without_abandoned(all), (std::vector{all[0], all[1]}));
  abandoned.turned_back(some);
  EXPECT_EQ(abandoned.without_abandoned(all), std::vector{all[1]});
  abandoned.turned_back(some);
  VoxelGrid grid(0.1);
  for (const VoxelKey& key : some) grid.set(key, Occupancy::kFree);
  abandoned.forget_known(all, grid);
  EXPECT_EQ(abandoned.without_abandoned(all), all);
  for (int times = 0; times < 4; ++times) abandoned.turned_back(some);
  EXPECT_EQ(abandoned.without_abandoned(all), all) << "as if for the first time";
}

TEST(AbandonedFrontiers, AreForgottenOnceTheyAreKnown) {
  detail::AbandonedFrontiers abandoned(2);
  const std::vector<VoxelKey> all = {{1, 7, 9}, {2, 7, 9}, {3, 7, 9}};
  for (int visits = 0; visits < 2; ++visits) abandoned.visited(all);
  EXPECT_TRUE(abandoned.without_abandoned(all).empty());
  VoxelGrid grid(0.1);
  abandoned.forget_known(all, grid);  // they are unknown
  EXPECT_TRUE(abandoned.without_abandoned(all).empty());
  grid.set(all[1], Occupancy::kFree);
  abandoned.forget_known(all, grid);
  EXPECT_EQ(abandoned.without_abandoned(all), std::vector<VoxelKey>{all[1]});
  abandoned.visited(std::vector<VoxelKey>{all[1]});  // as if for the first time
  EXPECT_EQ(abandoned.without_abandoned(all), std::vector<VoxelKey>{all[1]});
}

}  // namespace
}  // namespace frontlux::planner
