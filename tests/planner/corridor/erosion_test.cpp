// Erosion against its definition, voxel by voxel.

#include "corridor/erosion.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

bool is_whole(const VoxelGrid& grid, const KeyBox& box, const VoxelWindow& window, const VoxelKey& key) {
  const auto at = [&](const auto& offset) { return offset_key(key, offset[0], offset[1], offset[2]); };
  const auto low = at(window.low), high = at(window.high);
  return low && high && box.contains(*low) && box.contains(*high) && test::is_free(grid, {*low, *high});
}

// Boxes of up to four words a column, on bricks and off them, at both ends of the key range and in its
// middle.
TEST(Erosion, EqualsBruteForceAfterRandomChanges) {
  std::size_t whole = 0, broken = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    Random random(seed);
    const int size_z = 1 + random.below(seed % 3 == 0 ? 200 : 30), x = random.one_in(3) ? 0 : 32763;
    const VoxelKey corner = make_key(x, 32760 + random.below(9), random.one_in(3) ? 65536 - size_z : 37);
    const KeyBox box{corner,
                     make_key(x + random.below(20), corner.y + random.below(20), corner.z + size_z - 1)};
    VoxelWindow window;
    for (std::size_t a = 0; a < 3; ++a) {
      window.low[a] = -random.below(a == 2 && seed % 5 == 0 ? 70 : 3);
      window.high[a] = random.below(3);
    }
    VoxelGrid grid(0.1);
    for_each_key(grown(box, 3), [&](const VoxelKey& key) {
      if (!random.one_in(80)) grid.set(key, Occupancy::kFree);
    });
    Erosion erosion(box, window);
    erosion.read(grid);
    for (int round = 0; round < 4; ++round) {
      for_each_key(grown(box, 3), [&](const VoxelKey& key) {
        const bool expected = box.contains(key) && is_whole(grid, box, window, key);
        ASSERT_EQ(erosion.whole(key), expected) << "seed " << seed << ", round " << round;
        (expected ? whole : broken) += 1;
      });
      std::vector<VoxelKey> changed;
      for_each_key(grown(box, 3), [&](const VoxelKey& key) {
        if (!random.one_in(150)) return;
        grid.set(key, random.one_in(4) ? random.state() : Occupancy::kFree);
        changed.push_back(key);
      });
      erosion.read(grid, changed);
    }
  }
  EXPECT_GT(whole, 10'000U);
  EXPECT_GT(broken, 10'000U);
}

}  // namespace
}  // namespace frontlux::planner::detail
