#include "support/complaint.hpp"
#include "support/plain_frontiers.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/frontier_set.hpp>

namespace frontlux {
namespace {

using test::frontiers_by_hand;
using test::Random;

void expect_frontiers(const FrontierSet& set, const VoxelGrid& grid, const KeyBox& bounds,
                      Adjacency adjacency, const std::string& where) {
  const auto expected = frontiers_by_hand(grid, bounds, adjacency);
  ASSERT_TRUE(std::ranges::equal(set.keys(), expected))
      << where << ": " << set.size() << " and " << expected.size();
  for (const VoxelKey& key : expected) ASSERT_TRUE(set.contains(key)) << where;
}

KeyBox around(int x, int y, int z, int reach) { return grown(cube(make_key(x, y, z), 1), reach); }

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
          const Block block = random.block_in(edits, random.one_in(4) ? random.below(4) : 0);
          grid.fill(block, random.state());
          for_each_key(cube(block.corner, 1 << block.log2_edge),
                       [&](const VoxelKey& k) { changed.push_back(k); });
        }
        set.update({grid, changed});
        const std::string where = "at " + std::to_string(x) + ", round " + std::to_string(round);
        expect_frontiers(set, grid, bounds, adjacency, where);
        expect_frontiers(FrontierSet(grid, bounds, adjacency), grid, bounds, adjacency, where + ", anew");
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

// A file of a few bytes may hold a leaf whose frontiers take gigabytes.
TEST(FrontierSet, RefusesTheSurfaceOfAGiantBlock) {
  VoxelGrid grid(0.1);
  grid.fill({{0, 0, 0}, 15}, Occupancy::kFree);
  EXPECT_THROW(FrontierSet(grid, kAllVoxels), std::length_error);
  const KeyBox part = around(32768, 100, 100, 10);  // beside it
  expect_frontiers(FrontierSet(grid, part), grid, part, Adjacency::kFaces, "part");
}

TEST(FrontierSet, RefusesMoreFrontiersThanItMayHave) {
  VoxelGrid grid(0.1);
  const VoxelKey first = {100, 100, 100}, second = {200, 100, 100};
  grid.set(first, Occupancy::kFree);
  EXPECT_THROW(FrontierSet(grid, kAllVoxels, Adjacency::kFaces, 5), std::length_error);
  FrontierSet frontiers(grid, kAllVoxels, Adjacency::kFaces, 6);
  grid.set(second, Occupancy::kFree);
  EXPECT_THROW(frontiers.update({grid, {&second, 1}}), std::length_error);
  EXPECT_EQ(frontiers.size(), 6U);
  EXPECT_FALSE(frontiers.contains({199, 100, 100}));
  // As many go as come, whichever are found first.
  grid.set(first, Occupancy::kUnknown);
  const std::array both = {first, second};
  frontiers.update({grid, both});
  EXPECT_EQ(frontiers.size(), 6U);
  EXPECT_TRUE(frontiers.contains({199, 100, 100}));
  grid.set(first, Occupancy::kFree);
  grid.set(second, Occupancy::kUnknown);
  frontiers.update({grid, both});
  expect_frontiers(FrontierSet(grid, around(100, 100, 100, 10)), grid, around(100, 100, 100, 10),
                   Adjacency::kFaces, "back");
  EXPECT_EQ(frontiers.size(), 6U);
}

TEST(FrontierSet, RefusesOtherVoxelsAndOtherNeighbours) {
  VoxelGrid grid(0.1);
  const VoxelKey key = {100, 100, 100};
  grid.set(key, Occupancy::kFree);
  FrontierSet frontiers(grid, kAllVoxels);
  test::expect_complaint([&] { frontiers.update({VoxelGrid(0.2), {&key, 1}}); }, {"0.1 m", "0.2 m"});
  EXPECT_EQ(frontiers.size(), 6U);
  test::expect_complaint([&] { const FrontierSet other(grid, kAllVoxels, static_cast<Adjacency>(7)); },
                         {"adjacency", "7"});
}

}  // namespace
}  // namespace frontlux
