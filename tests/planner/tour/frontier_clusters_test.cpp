#include "tour/frontier_clusters.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;
using Keys = std::vector<VoxelKey>;

constexpr KeyBox kBounds{{1000, 1000, 1000}, {1030, 1024, 1012}};

// Patches of surfaces, as frontiers are.
Keys random_frontiers(Random& random, int patches) {
  std::set<VoxelKey> keys;
  for (int i = 0; i < patches; ++i) {
    const VoxelKey middle = random.key_in(kBounds);
    const int wide = random.below(6), deep = random.below(6);
    KeyBox patch = grown({middle, middle}, wide, deep, random.below(4));
    if (random.one_in(2))
      patch.min.x = patch.max.x;
    else
      patch.min.y = patch.max.y;
    if (const auto inside = intersection(patch, kBounds))
      for_each_key(*inside, [&](const VoxelKey& key) { keys.insert(key); });
  }
  return {keys.begin(), keys.end()};
}

// The voxels that neighbours connect with the first one.
Keys connected_by_hand(const Keys& keys) {
  std::set<VoxelKey> rest(keys.begin(), keys.end());
  Keys found{keys.front()};
  rest.erase(keys.front());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const VoxelKey at = found[i];
    for_each_key(grown({at, at}, 1), [&](const VoxelKey& key) {
      if (rest.erase(key) != 0) found.push_back(key);
    });
  }
  test::sort(found);
  return found;
}

TEST(FrontierClusters, HoldEachFrontierOnceInConnectedPartsOfBoundedSize) {
  constexpr int kEdge = 7;
  constexpr std::size_t kLeast = 5;
  Random random(41);
  for (int round = 0; round < 60; ++round) {
    const Keys frontiers = random_frontiers(random, 1 + random.below(12));
    FrontierClusters clusters(kBounds, kEdge, kLeast);
    clusters.update(frontiers);
    std::set<VoxelKey> seen;
    std::set<ClusterId> ids;
    for (const FrontierCluster& cluster : clusters.clusters()) {
      EXPECT_TRUE(ids.insert(cluster.id).second);
      EXPECT_GE(cluster.keys.size(), kLeast);
      EXPECT_TRUE(std::ranges::is_sorted(cluster.keys));
      EXPECT_EQ(cluster.box, bounds_of(cluster.keys));
      EXPECT_EQ(connected_by_hand(cluster.keys), cluster.keys);
      for (const VoxelKey& key : cluster.keys) {
        EXPECT_TRUE(seen.insert(key).second);
        EXPECT_TRUE(std::ranges::binary_search(frontiers, key));
      }
    }
    // What is left out is in parts that are too small, all together.
    Keys rest;
    for (const VoxelKey& key : frontiers)
      if (!seen.contains(key)) rest.push_back(key);
    while (!rest.empty()) {
      const Keys part = connected_by_hand(rest);
      Keys others;
      std::ranges::set_difference(rest, part, std::back_inserter(others));
      rest = others;
      EXPECT_LT(part.size(), kLeast * 8) << "a part of this size lies in a cube with enough of it";
    }
  }
}

// Pieces of 4 x 1 x n frontiers, one in each cube along x, that touch each other in a row. None is large
// enough alone.
TEST(FrontierClusters, JoinSmallPiecesThatTouchInARow) {
  constexpr int kEdge = 4;
  for (const std::vector<int>& sizes : std::vector<std::vector<int>>{
           {7, 6, 6}, {6, 6, 7}, {6, 7, 6}, {5, 4, 4}, {4, 4, 5}, {7, 4, 6}, {4, 4, 4, 4}}) {
    Keys frontiers;
    int x = 0;
    for (const int size : sizes) {
      const VoxelKey corner = make_key(1000 + x, 1000, 1000);
      for (int i = 0; i < size; ++i)
        frontiers.push_back(make_key(corner.x + i % kEdge, corner.y, corner.z + i / kEdge));
      x += kEdge;
    }
    test::sort(frontiers);
    FrontierClusters clusters(kBounds, kEdge, 8);
    clusters.update(frontiers);
    ASSERT_EQ(clusters.clusters().size(), 1U) << sizes.front() << ", " << sizes[1] << ", " << sizes[2];
    EXPECT_EQ(clusters.clusters().front().keys, frontiers);
  }
}

// A floor all of frontiers, and lines of them, as cubes of a sensor of short range cut them: each piece is
// too small, and touches the next.
TEST(FrontierClusters, DoNotChainSmallPiecesThroughTheWorld) {
  constexpr KeyBox kWide{{1000, 1000, 1000}, {1149, 1089, 1002}};
  constexpr std::size_t kLeast = 17;
  for (const int edge : {1, 2, 4})
    for (const int apart : {1, 5}) {  // lines along x
      Keys frontiers;
      for (int x = kWide.min.x; x <= kWide.max.x; ++x)
        for (int y = kWide.min.y; y <= kWide.max.y; y += apart) frontiers.push_back(make_key(x, y, 1001));
      FrontierClusters clusters(kWide, edge, kLeast);
      clusters.update(frontiers);
      std::size_t held = 0;
      for (const FrontierCluster& cluster : clusters.clusters()) {
        held += cluster.keys.size();
        EXPECT_LE(cluster.box.max.x - cluster.box.min.x, 40) << edge << ", " << apart;
        EXPECT_LE(cluster.box.max.y - cluster.box.min.y, 40) << edge << ", " << apart;
      }
      EXPECT_GT(held, frontiers.size() * 9 / 10) << edge << ", " << apart;
    }
}

TEST(FrontierClusters, KeepTheirIdsAndRevisionsWhileTheyStay) {
  Random random(42);
  Keys frontiers = random_frontiers(random, 10);
  FrontierClusters clusters(kBounds, 8, 3);
  clusters.update(frontiers);
  const std::vector<FrontierCluster> before(clusters.clusters().begin(), clusters.clusters().end());
  ASSERT_GT(before.size(), 4u);
  clusters.update(frontiers);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(clusters.clusters()[i].id, before[i].id);
    EXPECT_EQ(clusters.clusters()[i].revision, before[i].revision);
  }
  // One frontier less changes one cluster, and not who it is.
  const VoxelKey gone = before[2].keys.back();
  std::erase(frontiers, gone);
  clusters.update(frontiers);
  std::size_t changed = 0;
  for (const FrontierCluster& cluster : clusters.clusters()) {
    const auto old = std::ranges::find(before, cluster.id, &FrontierCluster::id);
    if (old == before.end() || old->revision != cluster.revision) ++changed;
  }
  EXPECT_GE(changed, 1u);
  EXPECT_LE(changed, 2u);  // it may fall into two
}

// Also if few frontiers change at a time, so that most clusters and pieces are kept.
TEST(FrontierClusters, AreTheSameAsNewOnesAfterFewChanges) {
  Random random(44);
  FrontierClusters kept(kBounds, 6, 4);
  const Keys begin = random_frontiers(random, 9);
  std::set<VoxelKey> frontiers(begin.begin(), begin.end());
  std::size_t stayed = 0;
  for (int round = 0; round < 150; ++round) {
    const Keys some = random_frontiers(random, 1);
    for (std::size_t i = 0; i < some.size(); ++i)
      if (random.below(20) == 0 && !frontiers.erase(some[i])) frontiers.insert(some[i]);
    const Keys now(frontiers.begin(), frontiers.end());
    const std::vector<FrontierCluster> before(kept.clusters().begin(), kept.clusters().end());
    kept.update(now);
    FrontierClusters anew(kBounds, 6, 4);
    anew.update(now);
    ASSERT_EQ(kept.clusters().size(), anew.clusters().size());
    std::map<VoxelKey, ClusterId> id_of;
    std::set<ClusterId> ids;
    for (std::size_t i = 0; i < anew.clusters().size(); ++i) {
      const FrontierCluster& cluster = kept.clusters()[i];
      EXPECT_EQ(cluster.keys, anew.clusters()[i].keys);
      EXPECT_EQ(cluster.box, bounds_of(cluster.keys));
      EXPECT_TRUE(ids.insert(cluster.id).second);
      EXPECT_EQ(&kept.cluster(cluster.id), &cluster);
      for (const VoxelKey& key : cluster.keys) id_of[key] = cluster.id;
      // The same frontiers have the same revision, and others another one.
      const auto old = std::ranges::find(before, cluster.id, &FrontierCluster::id);
      if (old == before.end()) continue;
      EXPECT_EQ(old->revision == cluster.revision, old->keys == cluster.keys);
      stayed += old->keys == cluster.keys ? 1 : 0;
    }
    for (const VoxelKey& key : now)
      EXPECT_EQ(kept.cluster_of(key), id_of.contains(key) ? id_of[key] : ClusterId::kNone);
  }
  EXPECT_GT(stayed, 500u);
}

TEST(FrontierClusters, AreTheSameAsNewOnes) {
  Random random(43);
  FrontierClusters kept(kBounds, 6, 4);
  std::size_t least = 4;
  for (int round = 0; round < 40; ++round) {
    const Keys frontiers = random_frontiers(random, random.below(10));
    if (random.one_in(2)) kept.set_least(least = static_cast<std::size_t>(1 + random.below(8)));
    kept.update(frontiers);
    if (random.one_in(2)) kept.set_least(least = static_cast<std::size_t>(1 + random.below(8)));
    FrontierClusters anew(kBounds, 6, least);
    anew.update(frontiers);
    ASSERT_EQ(kept.clusters().size(), anew.clusters().size());
    for (std::size_t i = 0; i < anew.clusters().size(); ++i)
      EXPECT_EQ(kept.clusters()[i].keys, anew.clusters()[i].keys);
  }
}

TEST(FrontierClusters, HoldFewFrontiersWhereThereAreExceptions) {
  constexpr std::size_t kLeast = 12;
  const auto is_even = [](std::span<const VoxelKey> keys) { return keys.size() % 2 == 0; };
  Random random(44);
  FrontierClusters kept(kBounds, 6, kLeast);
  std::size_t exceptions = 0, left_out = 0;
  for (int round = 0; round < 200; ++round) {
    const Keys frontiers = random_frontiers(random, random.below(10));
    const bool excepts = random.one_in(2);
    kept.set_least(kLeast, excepts ? is_even : FrontierClusters::Exceptions());
    kept.update(frontiers, excepts ? is_even : FrontierClusters::Exceptions());
    FrontierClusters all(kBounds, 6, kLeast);  // of any size
    all.update(frontiers, [](std::span<const VoxelKey>) { return true; });
    std::vector<Keys> expected, found;
    for (const FrontierCluster& cluster : all.clusters()) {
      const bool is_small = cluster.keys.size() < kLeast;
      const bool counts = !is_small || (excepts && is_even(cluster.keys));
      if (counts) expected.push_back(cluster.keys);
      if (counts && is_small) ++exceptions;
      if (!counts) ++left_out;
    }
    for (const FrontierCluster& cluster : kept.clusters()) found.push_back(cluster.keys);
    EXPECT_EQ(found, expected);
  }
  EXPECT_GT(exceptions, 10U);
  EXPECT_GT(left_out, 10U);
}

}  // namespace
}  // namespace frontlux::planner::detail
