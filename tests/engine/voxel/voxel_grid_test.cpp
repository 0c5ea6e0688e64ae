#include "support/random.hpp"

#include <frontlux/voxel_grid.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <vector>

namespace frontlux::test {
namespace {

constexpr Occupancy kStates[] = {Occupancy::kUnknown, Occupancy::kFree, Occupancy::kOccupied};

// The oracle: a dense cube of voxels, 128 a side, which crosses the borders of all kinds of storage nodes.
class DenseCube {
 public:
  static constexpr int kEdge = 128;
  static constexpr int kLow = 32768 - 64;

  void fill(const Block& block, Occupancy state) {
    const int edge = 1 << block.log2_edge;
    for (int z = 0; z < edge; ++z)
      for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
          voxels_[index(block.corner.x + x, block.corner.y + y, block.corner.z + z)] = state;
  }
  [[nodiscard]] Occupancy at(const VoxelKey& key) const { return voxels_[index(key.x, key.y, key.z)]; }

  template <class Visit>
  static void for_each_key(const Visit& visit) {
    for (int z = kLow; z < kLow + kEdge; ++z)
      for (int y = kLow; y < kLow + kEdge; ++y)
        for (int x = kLow; x < kLow + kEdge; ++x)
          visit(VoxelKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                         static_cast<std::uint16_t>(z)});
  }

 private:
  static std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>(((z - kLow) * kEdge + (y - kLow)) * kEdge + (x - kLow));
  }
  std::vector<Occupancy> voxels_ = std::vector<Occupancy>(std::size_t{kEdge} * kEdge * kEdge);
};

struct Edit {
  Block block;
  Occupancy state;
};

Edit random_edit(Random& random) {
  const int log2_edge = random.one_in(3) ? random.below(7) : 0;
  const auto along = [&] {
    const int at = DenseCube::kLow + random.below(DenseCube::kEdge);
    return static_cast<std::uint16_t>(at >> log2_edge << log2_edge);
  };
  return {{{along(), along(), along()}, log2_edge}, kStates[random.below(3)]};
}

TEST(VoxelGrid, EqualsADenseArrayAfterRandomEdits) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    VoxelGrid grid(0.1);
    DenseCube dense;
    for (int i = 0; i < 4000; ++i) {
      const Edit edit = random_edit(random);
      grid.fill(edit.block, edit.state);
      dense.fill(edit.block, edit.state);
    }
    std::array<std::uint64_t, 3> count{};
    KeyBox box{{0xFFFF, 0xFFFF, 0xFFFF}, {0, 0, 0}};
    DenseCube::for_each_key([&](const VoxelKey& key) {
      ASSERT_EQ(grid.at(key), dense.at(key));
      ++count[static_cast<std::size_t>(dense.at(key))];
      if (dense.at(key) == Occupancy::kUnknown) return;
      box.min = {std::min(box.min.x, key.x), std::min(box.min.y, key.y), std::min(box.min.z, key.z)};
      box.max = {std::max(box.max.x, key.x), std::max(box.max.y, key.y), std::max(box.max.z, key.z)};
    });
    EXPECT_EQ(grid.count()[1], count[1]);
    EXPECT_EQ(grid.count()[2], count[2]);
    EXPECT_EQ(grid.count()[0] + count[1] + count[2], std::uint64_t{1} << 48);
    EXPECT_EQ(grid.known_bounds(), box);

    std::uint64_t visited = 0;
    grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
      if (brick == nullptr) {
        EXPECT_EQ(grid.at(block.corner), state);
        visited += std::uint64_t{1} << (3 * block.log2_edge);
      } else {
        EXPECT_EQ(*brick, grid.brick(block.corner));
        for (const auto layer : brick->free) visited += static_cast<std::uint64_t>(std::popcount(layer));
        for (const auto layer : brick->occupied) visited += static_cast<std::uint64_t>(std::popcount(layer));
      }
    });
    EXPECT_EQ(visited, count[1] + count[2]);
  }
}

TEST(VoxelGrid, ACopyIsASnapshot) {
  Random random(7);
  VoxelGrid grid(0.1);
  for (int i = 0; i < 1000; ++i) {
    const Edit edit = random_edit(random);
    grid.fill(edit.block, edit.state);
  }
  const VoxelGrid before = grid;
  std::map<VoxelKey, Occupancy> remembered;
  DenseCube::for_each_key([&](const VoxelKey& key) {
    if (random.one_in(50)) remembered[key] = before.at(key);
  });
  for (int i = 0; i < 1000; ++i) {
    const Edit edit = random_edit(random);
    grid.fill(edit.block, edit.state);
  }
  for (const auto& [key, state] : remembered) ASSERT_EQ(before.at(key), state);
  EXPECT_FALSE(before == grid);
}

TEST(VoxelGrid, ChangesAreFoundExactly) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    VoxelGrid grid(0.1);
    const int edits = random.below(200);
    for (int i = 0; i < edits; ++i) {
      const Edit edit = random_edit(random);
      grid.fill(edit.block, edit.state);
    }
    VoxelGrid after = grid;
    for (int i = 0; i < 5; ++i) {
      const Edit edit = random_edit(random);
      after.fill(edit.block, edit.state);
    }
    std::vector<Block> changed;
    for_each_change(grid, after, [&](const Block& block) { changed.push_back(block); });
    for (const Block& block : changed) {  // each block holds a change
      bool differs = false;
      for (int i = 0; i < 1 << (3 * std::min(block.log2_edge, 6)); ++i) {
        const int mask = (1 << block.log2_edge) - 1;
        const auto at = [](std::uint16_t base, int offset) {
          return static_cast<std::uint16_t>(base + offset);
        };
        const VoxelKey key{at(block.corner.x, i & mask), at(block.corner.y, (i >> block.log2_edge) & mask),
                           at(block.corner.z, i >> (2 * block.log2_edge))};
        differs = differs || grid.at(key) != after.at(key);
      }
      EXPECT_TRUE(differs);
    }
    DenseCube::for_each_key([&](const VoxelKey& key) {  // and each change is in a block
      if (grid.at(key) == after.at(key)) return;
      const bool covered = std::any_of(changed.begin(), changed.end(), [&](const Block& b) {
        return key.x >> b.log2_edge == b.corner.x >> b.log2_edge &&
               key.y >> b.log2_edge == b.corner.y >> b.log2_edge &&
               key.z >> b.log2_edge == b.corner.z >> b.log2_edge;
      });
      ASSERT_TRUE(covered);
    });
    EXPECT_EQ(grid == after, changed.empty());
  }
}

TEST(VoxelGrid, EqualVoxelsAreEqualGridsHoweverTheyCameAbout) {
  VoxelGrid at_once(0.1), bit_by_bit(0.1);
  at_once.fill({{4096, 4096, 4096}, 6}, Occupancy::kOccupied);
  for (std::uint16_t x = 0; x < 64; ++x)
    for (std::uint16_t y = 0; y < 64; ++y)
      for (std::uint16_t z = 0; z < 64; ++z)
        bit_by_bit.set({static_cast<std::uint16_t>(4096 + x), static_cast<std::uint16_t>(4096 + y),
                        static_cast<std::uint16_t>(4096 + z)},
                       Occupancy::kOccupied);
  EXPECT_TRUE(at_once == bit_by_bit);
  EXPECT_EQ(at_once.memory_bytes(), bit_by_bit.memory_bytes());  // uniform again, so one entry again
  EXPECT_FALSE(at_once == VoxelGrid(0.1));
  EXPECT_FALSE(VoxelGrid(0.1) == VoxelGrid(0.2));
}

TEST(VoxelGrid, HugeBlocksAreOneEntry) {
  VoxelGrid grid(0.1);
  grid.fill({{32768, 32768, 32768}, 15}, Occupancy::kFree);
  EXPECT_EQ(grid.count()[1], std::uint64_t{1} << 45);
  EXPECT_EQ(grid.known_bounds(), (KeyBox{{32768, 32768, 32768}, {65535, 65535, 65535}}));
  EXPECT_LT(grid.memory_bytes(), std::size_t{100'000});
  grid.fill({{}, 16}, Occupancy::kOccupied);
  EXPECT_EQ(grid.count()[2], std::uint64_t{1} << 48);
  EXPECT_EQ(grid.at({65535, 0, 12345}), Occupancy::kOccupied);
  grid.fill({{}, 16}, Occupancy::kUnknown);
  EXPECT_TRUE(grid == VoxelGrid(0.1));
  EXPECT_FALSE(grid.known_bounds());
}

TEST(VoxelGrid, RejectsBlocksThatAreNotAligned) {
  VoxelGrid grid(0.1);
  EXPECT_THROW(grid.fill({{1, 0, 0}, 1}, Occupancy::kFree), std::invalid_argument);
  EXPECT_THROW(grid.fill({{0, 0, 0}, 17}, Occupancy::kFree), std::invalid_argument);
  EXPECT_THROW(grid.fill({{0, 0, 0}, -1}, Occupancy::kFree), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::test
