// Erosion against its definition, voxel by voxel.

#include "corridor/erosion.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

bool is_whole(const VoxelGrid& grid, const KeyBox& box, const VoxelWindow& window, bool beyond,
              const VoxelKey& key) {
  for (int x = window.low[0]; x <= window.high[0]; ++x)
    for (int y = window.low[1]; y <= window.high[1]; ++y)
      for (int z = window.low[2]; z <= window.high[2]; ++z) {
        const auto at = offset_key(key, x, y, z);
        const bool inside = at && box.contains(*at);
        if (inside ? grid.at(*at) != Occupancy::kFree : !beyond) return false;
      }
  return true;
}

// All of the map at first, then what has changed.
void read(VoxelColumns& columns, Erosion& erosion, const VoxelGrid& grid,
          const std::optional<std::vector<VoxelKey>>& changed) {
  if (changed)
    columns.read(grid, Occupancy::kFree, *changed);
  else
    columns.read(grid, Occupancy::kFree);
  erosion.erode(columns);
  columns.clear_stale();
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
    const bool beyond = seed % 4 == 0;
    VoxelColumns columns(box, beyond);
    Erosion erosion(box, window, beyond);
    read(columns, erosion, grid, std::nullopt);
    for (int round = 0; round < 4; ++round) {
      for_each_key(grown(box, 3), [&](const VoxelKey& key) {
        const bool expected = box.contains(key) && is_whole(grid, box, window, beyond, key);
        ASSERT_EQ(erosion.whole(key), expected) << "seed " << seed << ", round " << round;
        (expected ? whole : broken) += 1;
      });
      std::vector<VoxelKey> changed;
      for_each_key(grown(box, 3), [&](const VoxelKey& key) {
        if (!random.one_in(150)) return;
        grid.set(key, random.one_in(4) ? random.state() : Occupancy::kFree);
        changed.push_back(key);
      });
      read(columns, erosion, grid, changed);
    }
  }
  EXPECT_GT(whole, 10'000U);
  EXPECT_GT(broken, 10'000U);
}

}  // namespace
}  // namespace frontlux::planner::detail
