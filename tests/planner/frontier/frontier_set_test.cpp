#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/mapping.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::planner {
namespace {

using test::Random;

std::uint16_t key_at(int k) { return static_cast<std::uint16_t>(k); }

// Voxel by voxel, neighbour by neighbour.
std::vector<VoxelKey> frontiers_by_hand(const VoxelGrid& grid, const KeyBox& bounds, Adjacency adjacency) {
  std::vector<VoxelKey> frontiers;
  const auto is_free = [&](int x, int y, int z) {
    const auto in_range = [](int k) { return k >= 0 && k <= 0xFFFF; };
    return in_range(x) && in_range(y) && in_range(z) &&
           grid.at({key_at(x), key_at(y), key_at(z)}) == Occupancy::kFree;
  };
  for (int x = bounds.min.x; x <= bounds.max.x; ++x)
    for (int y = bounds.min.y; y <= bounds.max.y; ++y)
      for (int z = bounds.min.z; z <= bounds.max.z; ++z) {
        if (grid.at({key_at(x), key_at(y), key_at(z)}) != Occupancy::kUnknown) continue;
        bool frontier = false;
        for (int dx = -1; dx <= 1; ++dx)
          for (int dy = -1; dy <= 1; ++dy)
            for (int dz = -1; dz <= 1; ++dz)
              if (adjacency == Adjacency::kCorners || std::abs(dx) + std::abs(dy) + std::abs(dz) == 1)
                frontier = frontier || is_free(x + dx, y + dy, z + dz);
        if (frontier) frontiers.push_back({key_at(x), key_at(y), key_at(z)});
      }
  return frontiers;
}

void expect_frontiers(const FrontierSet& set, const VoxelGrid& grid, const KeyBox& bounds,
                      Adjacency adjacency, const std::string& where) {
  const auto expected = frontiers_by_hand(grid, bounds, adjacency);
  ASSERT_TRUE(std::ranges::equal(set.keys(), expected))
      << where << ": " << set.size() << " and " << expected.size();
  for (const VoxelKey& key : expected) ASSERT_TRUE(set.contains(key)) << where;
}

KeyBox around(int x, int y, int z, int reach) {
  const auto clipped = [](int k) { return key_at(std::clamp(k, 0, 0xFFFF)); };
  return {{clipped(x - reach), clipped(y - reach), clipped(z - reach)},
          {clipped(x + reach), clipped(y + reach), clipped(z + reach)}};
}

// Random voxels and blocks at places where bricks, tiles, sectors and the key range end.
TEST(FrontierSet, EqualsBruteForceUnderRandomEdits) {
  Random random(11);
  for (const auto& [x, y, z] :
       {std::array{32768, 32768, 32768}, std::array{4, 65531, 33000}, std::array{4095, 511, 64}})
    for (const Adjacency adjacency : {Adjacency::kFaces, Adjacency::kCorners}) {
      VoxelGrid grid(0.3);
      const KeyBox bounds = around(x, y, z, 13), edits = around(x, y, z, 17);
      FrontierSet set(grid, bounds, adjacency);
      for (int round = 0; round < 25; ++round) {
        std::vector<VoxelKey> changed;
        for (int i = 0; i < 1 + random.below(60); ++i) {
          const auto along = [&](std::uint16_t min, std::uint16_t max) {
            return key_at(min + random.below(max - min + 1));
          };
          VoxelKey key{along(edits.min.x, edits.max.x), along(edits.min.y, edits.max.y),
                       along(edits.min.z, edits.max.z)};
          const int log2_edge = random.one_in(4) ? random.below(4) : 0;
          const auto down = [&](std::uint16_t k) { return key_at((k >> log2_edge) << log2_edge); };
          key = {down(key.x), down(key.y), down(key.z)};
          grid.fill({key, log2_edge}, static_cast<Occupancy>(random.below(3)));
          for (int v = 0; v < 1 << (3 * log2_edge); ++v)
            changed.push_back({key_at(key.x + (v & ((1 << log2_edge) - 1))),
                               key_at(key.y + ((v >> log2_edge) & ((1 << log2_edge) - 1))),
                               key_at(key.z + (v >> (2 * log2_edge)))});
        }
        set.update({grid, changed});
        const std::string where = "at " + std::to_string(x) + ", round " + std::to_string(round);
        expect_frontiers(set, grid, bounds, adjacency, where);
        expect_frontiers(FrontierSet(grid, bounds, adjacency), grid, bounds, adjacency, where + ", anew");
        if (HasFatalFailure()) return;
      }
    }
}

Scan random_scan(Random& random) {
  Scan scan;
  for (int a = 0; a < 3; ++a) scan.origin[a] = static_cast<float>(random.uniform(-2.5, 2.5));
  scan.max_range = 4.0;
  const double yaw = random.uniform(-3.1, 3.1);
  for (int i = 0; i < 400; ++i) {
    const double azimuth = yaw + random.uniform(-0.8, 0.8), up = random.uniform(-0.6, 0.6);
    scan.directions.push_back(
        Eigen::Vector3d(std::cos(azimuth) * std::cos(up), std::sin(azimuth) * std::cos(up), std::sin(up))
            .cast<float>());
    scan.ranges.push_back(random.one_in(5) ? std::numeric_limits<float>::infinity()
                                           : static_cast<float>(random.uniform(0.5, 4.0)));
  }
  return scan;
}

TEST(FrontierSet, FollowsAMapScanByScan) {
  Random random(12);
  const Lattice lattice(0.3);
  const KeyBox bounds = voxels_of(lattice, {Eigen::Vector3d(-4, -4, -2), Eigen::Vector3d(4, 5, 2)});
  for (const Adjacency adjacency : {Adjacency::kFaces, Adjacency::kCorners}) {
    Mapping mapping({.resolution = 0.3, .bounds = bounds});
    FrontierSet set(mapping.grid(), bounds, adjacency);
    EXPECT_EQ(set.size(), 0U);
    for (int i = 0; i < 40; ++i) {
      set.update(i == 3 ? mapping.mark_free(test::keys_of(around(32771, 32771, 32768, 4)))
                        : mapping.insert(random_scan(random)));
      expect_frontiers(set, mapping.grid(), bounds, adjacency, "scan " + std::to_string(i));
      if (HasFatalFailure()) return;
    }
  }
}

// Pruned blocks as large as whole tiles: their surface is full of frontiers.
TEST(FrontierSet, FindsTheSurfaceOfLargeBlocks) {
  VoxelGrid grid(0.1);
  grid.fill({{32768, 32768, 32768}, 6}, Occupancy::kFree);
  grid.fill({{32768 + 64, 32768, 32768}, 3}, Occupancy::kOccupied);
  const KeyBox all = around(32800, 32800, 32800, 40), cut = around(32770, 32780, 32800, 20);
  for (const Adjacency adjacency : {Adjacency::kFaces, Adjacency::kCorners})
    for (const KeyBox& bounds : {all, cut})
      expect_frontiers(FrontierSet(grid, bounds, adjacency), grid, bounds, adjacency, "block");
  EXPECT_EQ(FrontierSet(grid, kAllVoxels).size(), 6U * 64U * 64U - 64U);
}

TEST(FrontierSet, ClustersByOctreeLevel) {
  Random random(13);
  VoxelGrid grid(0.3);
  const KeyBox bounds = around(32768, 32768, 32768, 15);
  for (int i = 0; i < 300; ++i) {
    const auto along = [&] { return key_at(32753 + random.below(31)); };
    grid.set({along(), along(), along()}, random.one_in(3) ? Occupancy::kOccupied : Occupancy::kFree);
  }
  const FrontierSet set(grid, bounds);
  const Lattice lattice(0.3);
  for (const int level : {0, 1, 3, 4, 16}) {
    std::map<VoxelKey, std::vector<Eigen::Vector3d>> expected;
    for (const VoxelKey& k : frontiers_by_hand(grid, bounds, Adjacency::kFaces)) {
      const auto down = [&](std::uint16_t c) { return key_at(c / (1 << level) * (1 << level)); };
      expected[{down(k.x), down(k.y), down(k.z)}].push_back(
          {lattice.center(k.x), lattice.center(k.y), lattice.center(k.z)});
    }
    const auto clusters = set.clusters(level);
    ASSERT_EQ(clusters.size(), expected.size());
    std::size_t i = 0;
    for (const auto& [corner, centers] : expected) {
      EXPECT_EQ(clusters[i].corner, corner);
      EXPECT_EQ(clusters[i].count, centers.size());
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const auto& c : centers) mean += c / static_cast<double>(centers.size());
      EXPECT_LT((clusters[i++].mean - mean).norm(), 1e-9);
    }
  }
  EXPECT_THROW(static_cast<void>(set.clusters(17)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(set.clusters(-1)), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::planner
