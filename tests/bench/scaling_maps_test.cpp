#include "scaling/maps.hpp"
#include "scaling/octree.hpp"
#include "support/quiet_octomap.hpp"
#include "support/random.hpp"

#include <frontlux/octomap.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <vector>

namespace frontlux::bench {
namespace {

VoxelKey key_at(int x, int y, int z) {
  return {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(z)};
}

KeyBox random_box(test::Random& random, int low, int edge) {
  int min[3], max[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int a = low + random.below(edge), b = low + random.below(edge);
    min[axis] = std::min(a, b);
    max[axis] = std::max(a, b);
  }
  return {key_at(min[0], min[1], min[2]), key_at(max[0], max[1], max[2])};
}

Occupancy random_state(test::Random& random) { return static_cast<Occupancy>(random.below(3)); }

// A cube that lies across the boundaries of bricks, tiles and regions.
constexpr int kLow = 32768 - 20, kEdge = 48;

VoxelGrid random_grid(std::uint64_t seed) {
  test::Random random(seed);
  VoxelGrid grid(0.1);
  for (int i = 0; i < 12; ++i) fill_box(grid, random_box(random, kLow, kEdge), random_state(random));
  for (int i = 0; i < 300; ++i) {
    const auto at = [&] { return kLow + random.below(kEdge); };
    grid.set(key_at(at(), at(), at()), random_state(random));
  }
  return grid;
}

TEST(FillBox, SetsTheVoxelsOfTheBoxAndNoOthers) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    test::Random random(seed);
    VoxelGrid grid(0.1);
    std::vector<Occupancy> dense(kEdge * kEdge * kEdge, Occupancy::kUnknown);
    for (int step = 0; step < 10; ++step) {
      const KeyBox box = random_box(random, kLow, kEdge);
      const Occupancy state = random_state(random);
      fill_box(grid, box, state);
      for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
        const VoxelKey key = key_at(kLow + i % kEdge, kLow + i / kEdge % kEdge, kLow + i / kEdge / kEdge);
        if (box.contains(key)) dense[static_cast<std::size_t>(i)] = state;
      }
    }
    std::uint64_t known = 0;
    for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const VoxelKey key = key_at(kLow + i % kEdge, kLow + i / kEdge % kEdge, kLow + i / kEdge / kEdge);
      const Occupancy expected = dense[static_cast<std::size_t>(i)];
      ASSERT_EQ(grid.at(key), expected) << key.x << ' ' << key.y << ' ' << key.z << ", seed " << seed;
      known += expected == Occupancy::kUnknown ? 0 : 1;
    }
    EXPECT_EQ(count_known(grid), known);
  }
}

TEST(FillBox, ReachesTheEndsOfTheKeyRange) {
  VoxelGrid grid(0.1);
  fill_box(grid, {key_at(65530, 0, 65535), key_at(65535, 2, 65535)}, Occupancy::kFree);
  EXPECT_EQ(count_known(grid), 18U);
  EXPECT_EQ(grid.at(key_at(65535, 2, 65535)), Occupancy::kFree);
  EXPECT_EQ(grid.at(key_at(65529, 2, 65535)), Occupancy::kUnknown);
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
    for (int z = kLow - 2; z < kLow + kEdge + 2; ++z) {
      for (int y = kLow - 2; y < kLow + kEdge + 2; ++y) {
        for (int x = kLow - 2; x < kLow + kEdge + 2; ++x) {
          const auto* node = tree->search(octomap::OcTreeKey(static_cast<octomap::key_type>(x),
                                                             static_cast<octomap::key_type>(y),
                                                             static_cast<octomap::key_type>(z)));
          const Occupancy found = node == nullptr              ? Occupancy::kUnknown
                                  : tree->isNodeOccupied(node) ? Occupancy::kOccupied
                                                               : Occupancy::kFree;
          ASSERT_EQ(found, grid.at(key_at(x, y, z))) << x << ' ' << y << ' ' << z << ", seed " << seed;
        }
      }
    }
  }
}

TEST(MakeOctree, IsAsSmallAsATreeOfTheSameVoxels) {
  VoxelGrid grid(0.2);
  fill_box(grid, {key_at(32768, 32768, 32768), key_at(32768 + 63, 32768 + 31, 32768 + 31)}, Occupancy::kFree);
  octomap::OcTree expected(0.2);
  for (int i = 0; i < 64 * 32 * 32; ++i) {
    expected.setNodeValue(octomap::OcTreeKey(static_cast<octomap::key_type>(32768 + i % 64),
                                             static_cast<octomap::key_type>(32768 + i / 64 % 32),
                                             static_cast<octomap::key_type>(32768 + i / 64 / 32)),
                          expected.getClampingThresMinLog(), true);
  }
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

TEST(Blocks, NoShareThatIsNone) {
  for (const double share : {-0.1, 0.6, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW((void)make_blocks(share), std::invalid_argument) << share;
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
      const VoxelKey next = key_at(at.x + dx, at.y + dy, at.z + dz);
      if (grid.at(next) != Occupancy::kFree || !seen.insert(next).second) continue;
      open.push_back(next);
    }
  }
  return seen.size();
}

TEST(RoomsMap, DoorsAndHatchesJoinAllRoomsAndNothingLeadsOut) {
  const VoxelGrid grid = make_rooms({2, 2, 2});
  const VoxelKey corner = key_at(32769, 32769, 32769);
  ASSERT_EQ(grid.at(corner), Occupancy::kFree);
  EXPECT_EQ(reachable(grid, corner), grid.count()[1]);
  const KeyBox bounds = grid.known_bounds().value();
  EXPECT_EQ(bounds, (KeyBox{key_at(32768, 32768, 32768), key_at(32768 + 128, 32768 + 128, 32768 + 64)}));
  // Not counted among the reachable: outside. No free voxel lies on the outermost layer.
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    const int edge = 1 << block.log2_edge;
    if (brick == nullptr && state != Occupancy::kFree) return;
    for (int i = 0; i < edge * edge * edge; ++i) {
      const VoxelKey key = key_at(block.corner.x + i % edge, block.corner.y + i / edge % edge,
                                  block.corner.z + i / edge / edge);
      if (grid.at(key) != Occupancy::kFree) continue;
      ASSERT_TRUE(key.x > bounds.min.x && key.x < bounds.max.x && key.y > bounds.min.y &&
                  key.y < bounds.max.y && key.z > bounds.min.z && key.z < bounds.max.z)
          << key.x << ' ' << key.y << ' ' << key.z;
    }
  });
}

TEST(RoomsMap, RoomsDiffer) {
  const VoxelGrid grid = make_rooms({2, 1, 1});
  int different = 0;
  for (int z = 1; z < Rooms::kHeight; ++z) {
    for (int y = 1; y < Rooms::kEdge; ++y) {
      for (int x = 1; x < Rooms::kEdge; ++x) {
        different += grid.at(key_at(32768 + x, 32768 + y, 32768 + z)) !=
                             grid.at(key_at(32768 + Rooms::kEdge + x, 32768 + y, 32768 + z))
                         ? 1
                         : 0;
      }
    }
  }
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
    EXPECT_THROW((void)make_rooms(rooms), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::bench
