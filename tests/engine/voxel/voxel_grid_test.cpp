#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/voxel_grid.hpp>

#include <thread>

namespace frontlux::test {
namespace {

// The oracle: a dense cube of voxels, 128 a side, which crosses the borders of all kinds of storage nodes.
class DenseCube {
 public:
  static constexpr int kEdge = 128;
  static constexpr KeyBox kBox = cube({32768 - 64, 32768 - 64, 32768 - 64}, kEdge);

  void fill(const Block& block, Occupancy state) {
    for_each_key(cube(block.corner, 1 << block.log2_edge), [&](const VoxelKey& key) { at(key) = state; });
  }
  Occupancy& at(const VoxelKey& key) {
    const auto along = [](int k, int low) { return static_cast<std::size_t>(k - low); };
    return voxels_[(along(key.z, kBox.min.z) * kEdge + along(key.y, kBox.min.y)) * kEdge +
                   along(key.x, kBox.min.x)];
  }

 private:
  std::vector<Occupancy> voxels_ = std::vector<Occupancy>(std::size_t{kEdge} * kEdge * kEdge);
};

struct Edit {
  Block block;
  Occupancy state;
};

Edit random_edit(Random& random) {
  const Block block = random.block_in(DenseCube::kBox, random.one_in(3) ? random.below(7) : 0);
  return {block, random.state()};
}

void edit_at_random(VoxelGrid& grid, Random& random, int edits) {
  for (; edits > 0; --edits) {
    const Edit edit = random_edit(random);
    grid.fill(edit.block, edit.state);
  }
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
    for_each_key(DenseCube::kBox, [&](const VoxelKey& key) {
      ASSERT_EQ(grid.at(key), dense.at(key));
      ++count[static_cast<std::size_t>(dense.at(key))];
      if (dense.at(key) == Occupancy::kUnknown) return;
      box = hull(box, {key, key});
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
  edit_at_random(grid, random, 1000);
  const VoxelGrid before = grid;
  std::map<VoxelKey, Occupancy> remembered;
  for_each_key(DenseCube::kBox, [&](const VoxelKey& key) {
    if (random.one_in(50)) remembered[key] = before.at(key);
  });
  edit_at_random(grid, random, 1000);
  for (const auto& [key, state] : remembered) ASSERT_EQ(before.at(key), state);
  EXPECT_FALSE(before == grid);
}

TEST(VoxelGrid, CopiesInDifferentThreadsAreIndependent) {
  Random random(8);
  VoxelGrid grid(0.1);
  edit_at_random(grid, random, 1000);
  const auto edited = [](VoxelGrid copy, std::uint64_t seed) {
    Random own(seed);
    for (int i = 0; i < 20; ++i) {
      const VoxelGrid before = copy;  // shared for as long as it lives
      edit_at_random(copy, own, 20);
    }
    return copy;
  };
  std::vector<VoxelGrid> expected, grids(4, grid);
  for (std::uint64_t seed = 0; seed < grids.size(); ++seed) expected.push_back(edited(grid, seed));
  std::vector<std::thread> threads;
  for (std::uint64_t seed = 0; seed < grids.size(); ++seed)
    threads.emplace_back([&, seed] { grids[seed] = edited(std::move(grids[seed]), seed); });
  grid = edited(grid, 0);
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < grids.size(); ++i) EXPECT_TRUE(grids[i] == expected[i]) << i;
  EXPECT_TRUE(grid == expected[0]);
}

TEST(VoxelGrid, ChangesAreFoundExactly) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    VoxelGrid grid(0.1);
    edit_at_random(grid, random, random.below(200));
    VoxelGrid after = grid;
    edit_at_random(after, random, 5);
    std::vector<Block> changed;
    for_each_change(grid, after, [&](const Block& block) { changed.push_back(block); });
    for (const Block& block : changed)  // each block holds a change
      EXPECT_FALSE(all_of(cube(block.corner, 1 << block.log2_edge),
                          [&](const VoxelKey& key) { return grid.at(key) == after.at(key); }));
    for_each_key(DenseCube::kBox, [&](const VoxelKey& key) {  // and each change is in a block
      if (grid.at(key) == after.at(key)) return;
      const bool covered = std::any_of(changed.begin(), changed.end(), [&](const Block& b) {
        return cube(b.corner, 1 << b.log2_edge).contains(key);
      });
      ASSERT_TRUE(covered);
    });
    EXPECT_EQ(grid == after, changed.empty());
  }
}

TEST(VoxelGrid, EqualVoxelsAreEqualGridsHoweverTheyCameAbout) {
  VoxelGrid at_once(0.1), bit_by_bit(0.1);
  at_once.fill({{4096, 4096, 4096}, 6}, Occupancy::kOccupied);
  fill(bit_by_bit, cube({4096, 4096, 4096}, 64), Occupancy::kOccupied);
  EXPECT_TRUE(at_once == bit_by_bit);
  EXPECT_LT(bit_by_bit.memory_bytes(), at_once.memory_bytes() + 100);  // uniform again, so one entry again
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

TEST(VoxelGrid, VoxelsFarApartTakeLittleMemory) {
  VoxelGrid grid(0.1);
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) grid.set(make_key(1000 * x, 1000 * y, 1000 * z), Occupancy::kOccupied);
  EXPECT_EQ(grid.count()[2], 4096U);
  EXPECT_LT(grid.memory_bytes(), std::size_t{4096 * 2720});
}

TEST(VoxelGrid, RejectsBlocksThatAreNotAligned) {
  VoxelGrid grid(0.1);
  for (const Block& bad : {Block{{1, 0, 0}, 1}, {{0, 0, 0}, 17}, {{0, 0, 0}, -1}})
    EXPECT_REFUSED(grid.fill(bad, Occupancy::kFree));
}

TEST(VoxelGrid, RejectsStatesThatThereAreNot) {
  VoxelGrid grid(0.1);
  for (const int state : {3, 77, 255}) EXPECT_REFUSED(grid.set({1, 1, 1}, static_cast<Occupancy>(state)));
  EXPECT_TRUE(grid == VoxelGrid(0.1));
}

TEST(VoxelGrid, ListsNoMoreVoxelsThanItMay) {
  VoxelGrid grid(0.1);
  EXPECT_REFUSED(keys_in(grid, Occupancy::kUnknown));
  grid.fill({{}, 16}, Occupancy::kFree);
  EXPECT_REFUSED(keys_in(grid, Occupancy::kUnknown));
  EXPECT_THROW(static_cast<void>(keys_in(grid, Occupancy::kFree)), std::length_error);
  EXPECT_TRUE(keys_in(grid, Occupancy::kOccupied).empty());
}

TEST(VoxelGrid, OfAnotherResolutionIsNotCompared) {
  EXPECT_FALSE(VoxelGrid(0.1) == VoxelGrid(0.2));
  EXPECT_REFUSED(changed_keys(VoxelGrid(0.1), VoxelGrid(0.2)));
}

}  // namespace
}  // namespace frontlux::test
