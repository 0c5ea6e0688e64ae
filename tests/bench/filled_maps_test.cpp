#include "maps/filled_maps.hpp"

#include "maps/octree.hpp"
#include "octomap/quiet_octomap.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/tree_state.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/octomap.hpp>

namespace frontlux::bench {
namespace {

KeyBox random_box(test::Random& random, const KeyBox& within) {
  const VoxelKey a = random.key_in(within), b = random.key_in(within);
  return {least(a, b), greatest(a, b)};
}

// A cube that lies across the boundaries of bricks, tiles and regions.
constexpr KeyBox kBox = cube({32768 - 20, 32768 - 20, 32768 - 20}, 48);

VoxelGrid random_grid(std::uint64_t seed) {
  test::Random random(seed);
  VoxelGrid grid(0.1);
  for (int i = 0; i < 12; ++i) fill_box(grid, random_box(random, kBox), random.state());
  for (int i = 0; i < 300; ++i) grid.set(random.key_in(kBox), random.state());
  return grid;
}

TEST(FillBox, SetsTheVoxelsOfTheBoxAndNoOthers) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    test::Random random(seed);
    VoxelGrid grid(0.1);
    std::map<VoxelKey, Occupancy> dense;
    for (int step = 0; step < 10; ++step) {
      const KeyBox box = random_box(random, kBox);
      const Occupancy state = random.state();
      fill_box(grid, box, state);
      for_each_key(box, [&](const VoxelKey& key) { dense[key] = state; });
    }
    std::uint64_t known = 0;
    for_each_key(kBox, [&](const VoxelKey& key) {
      const Occupancy expected = dense[key];
      ASSERT_EQ(grid.at(key), expected) << key.x << ' ' << key.y << ' ' << key.z << ", seed " << seed;
      known += expected == Occupancy::kUnknown ? 0 : 1;
    });
    EXPECT_EQ(count_known(grid), known);
  }
}

TEST(FillBox, ReachesTheEndsOfTheKeyRange) {
  VoxelGrid grid(0.1);
  fill_box(grid, {{65530, 0, 65535}, {65535, 2, 65535}}, Occupancy::kFree);
  EXPECT_EQ(count_known(grid), 18U);
  EXPECT_EQ(grid.at({65535, 2, 65535}), Occupancy::kFree);
  EXPECT_EQ(grid.at({65529, 2, 65535}), Occupancy::kUnknown);
}

void expect_same_map(const VoxelGrid& grid) {
  const auto tree = make_octree(grid);
  EXPECT_TRUE(make_voxel_grid(*tree) == grid);
  EXPECT_EQ(tree->getResolution(), grid.resolution());
  EXPECT_EQ(tree->size(), tree->calcNumNodes());
  // No inner node could be a leaf.
  for (auto it = tree->begin_tree(), end = tree->end_tree(); it != end; ++it)
    ASSERT_FALSE(!it.isLeaf() && tree->isNodeCollapsible(&*it));
}

TEST(MakeOctree, IsTheTreeOfTheGrid) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const VoxelGrid grid = random_grid(seed);
    expect_same_map(grid);
    const auto tree = make_octree(grid);
    // By OctoMap's own search, voxel by voxel and some beside.
    for_each_key(grown(kBox, 2), [&](const VoxelKey& key) {
      ASSERT_EQ(test::state_of(*tree, key), grid.at(key))
          << key.x << ' ' << key.y << ' ' << key.z << ", seed " << seed;
    });
  }
}

TEST(MakeOctree, IsAsSmallAsATreeOfTheSameVoxels) {
  const KeyBox box{{32768, 32768, 32768}, {32768 + 63, 32768 + 31, 32768 + 31}};
  VoxelGrid grid(0.2);
  fill_box(grid, box, Occupancy::kFree);
  octomap::OcTree expected(0.2);
  for_each_key(box, [&](const VoxelKey& key) {
    expected.setNodeValue(test::tree_key(key), expected.getClampingThresMinLog(), true);
  });
  expected.updateInnerOccupancy();
  expected.prune();
  EXPECT_TRUE(*make_octree(grid) == expected);
}

TEST(MakeOctree, UnknownMapIsAnEmptyTree) { EXPECT_EQ(make_octree(VoxelGrid(0.1))->getRoot(), nullptr); }

TEST(Blocks, FillTheShareOfTheBox) {
  constexpr std::uint64_t kVolume = std::uint64_t{kBlocksEdge} * kBlocksEdge * kBlocksHeight;
  for (const double share : {0.0, 1e-4, 0.01, 0.2}) {
    const VoxelGrid grid = make_blocks(share);
    const auto count = grid.count();
    const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(kVolume)));
    EXPECT_GE(count[2], wanted) << share;
    EXPECT_LT(count[2], wanted + 64) << share;
    EXPECT_EQ(count[1] + count[2], kVolume) << share;
    EXPECT_TRUE(grid == make_blocks(share)) << share;
  }
  EXPECT_EQ(make_blocks(0.01).resolution(), kBlocksResolution);
  expect_same_map(make_blocks(1e-3));
}

TEST(Site, IsLargeFreeSpace) {
  const VoxelGrid grid = make_site();
  EXPECT_EQ(grid.resolution(), 0.05);
  const auto count = grid.count();
  EXPECT_EQ(count[1] + count[2], 1200U * 1200U * 120U);
  EXPECT_GE(count[2], 1'728'000U);
  EXPECT_LT(count[2], 1'728'000U + 16 * 16 * 16);
}

TEST(Blocks, NoShareThatIsNone) {
  for (const double share : {-0.1, 0.6, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_REFUSED(make_blocks(share));
}

// Free voxels that can be reached from one of them through faces, counted by a plain flood over keys.
std::uint64_t reachable(const VoxelGrid& grid, const VoxelKey& from) {
  std::set<VoxelKey> seen{from};
  std::vector<VoxelKey> open{from};
  while (!open.empty()) {
    const VoxelKey at = open.back();
    open.pop_back();
    for (const auto& [dx, dy, dz] :
         {std::array{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      const VoxelKey next = *offset_key(at, dx, dy, dz);
      if (grid.at(next) != Occupancy::kFree || !seen.insert(next).second) continue;
      open.push_back(next);
    }
  }
  return seen.size();
}

TEST(RoomsMap, DoorsAndHatchesJoinAllRoomsAndNothingLeadsOut) {
  const VoxelGrid grid = make_rooms({2, 2, 2});
  const VoxelKey corner{32769, 32769, 32769};
  ASSERT_EQ(grid.at(corner), Occupancy::kFree);
  EXPECT_EQ(reachable(grid, corner), grid.count()[1]);
  const KeyBox bounds = grid.known_bounds().value();
  EXPECT_EQ(bounds, (KeyBox{{32768, 32768, 32768}, {32768 + 128, 32768 + 128, 32768 + 64}}));
  // Not counted among the reachable: outside. No free voxel lies on the outermost layer.
  for_each_key(grown(bounds, 1), [&](const VoxelKey& key) {
    ASSERT_TRUE(grid.at(key) != Occupancy::kFree ||
                (key.x > bounds.min.x && key.x < bounds.max.x && key.y > bounds.min.y &&
                 key.y < bounds.max.y && key.z > bounds.min.z && key.z < bounds.max.z))
        << key.x << ' ' << key.y << ' ' << key.z;
  });
}

TEST(RoomsMap, RoomsDiffer) {
  const VoxelGrid grid = make_rooms({2, 1, 1});
  int different = 0;
  for_each_key({test::key_at(1, 1, 1), test::key_at(Rooms::kEdge - 1, Rooms::kEdge - 1, Rooms::kHeight - 1)},
               [&](const VoxelKey& key) {
                 different += grid.at(key) != grid.at(*offset_key(key, Rooms::kEdge, 0, 0)) ? 1 : 0;
               });
  EXPECT_GT(different, 100);
}

TEST(RoomsMap, GrowsWithTheNumberOfRooms) {
  const VoxelGrid grid = make_rooms({3, 2, 1});
  const auto count = grid.count();
  // A room holds 63 x 63 x 31 voxels, its boxes at most 4 x 16 x 16 x 20.
  const std::uint64_t inside = std::uint64_t{6} * 63 * 63 * 31;
  EXPECT_LT(count[1], inside + 5 * 10 * 21);
  EXPECT_GT(count[1], inside - std::uint64_t{6} * 4 * 16 * 16 * 20);
  EXPECT_TRUE(grid == make_rooms({3, 2, 1}));
  expect_same_map(grid);
}

TEST(RoomsMap, NoRoomsAreNoMap) {
  for (const Rooms rooms : {Rooms{0, 1, 1}, {1, -1, 1}, {1, 1, 0}, {600, 1, 1}, {1, 600, 1}, {1, 1, 1200}})
    EXPECT_REFUSED(make_rooms(rooms));
}

TEST(TownMap, HasStreetsBetweenWalls) {
  constexpr int kEdge = 2100;  // three streets each way
  const VoxelGrid grid = make_town(kEdge);
  EXPECT_EQ(grid, make_town(kEdge));
  const auto at = [&](int x, int y, int z) {
    return grid.at(make_key(Lattice::kOrigin + x, Lattice::kOrigin + y, Lattice::kOrigin + z));
  };
  std::map<Occupancy, int> in_streets;
  for (int street = 0; street <= 2000; street += 1000)
    for (int along = 0; along < kEdge; ++along)
      for (const int across : {0, 20, 47}) {
        ++in_streets[at(street + across, along, 20)];
        ++in_streets[at(along, street + across, 20)];
        EXPECT_EQ(at(along, street + across, 7), Occupancy::kOccupied);  // the ground
      }
  EXPECT_EQ(in_streets[Occupancy::kUnknown], 0);
  EXPECT_GT(in_streets[Occupancy::kOccupied], 10);
  EXPECT_GT(in_streets[Occupancy::kFree], 90 * in_streets[Occupancy::kOccupied]);
  EXPECT_EQ(at(500, -4, 20), Occupancy::kOccupied);
  EXPECT_EQ(at(500, 52, 20), Occupancy::kOccupied);
  EXPECT_EQ(at(500, 500, 20), Occupancy::kUnknown);
  EXPECT_THROW(static_cast<void>(make_town(10)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(make_town(65536)), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::bench
