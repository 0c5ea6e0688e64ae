// The table of open voxels against the grid.

#include "packet/open_voxels.hpp"

#include "engine/packet/packet_maps.hpp"
#include "walk/walk.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

namespace frontlux::test {
namespace {

using detail::OpenVoxels;

TEST(OpenVoxels, EqualTheGridAndAreClosedAroundIt) {
  for (const VoxelGrid& grid : grids())
    for (const UnknownPolicy unknown : kPolicies) {
      const OpenVoxels table = table_of(grid, unknown, kAllVoxels);
      if (table.empty()) continue;
      const KeyBox known = *grid.known_bounds();
      std::size_t open = 0;
      const auto low = table.layout().corner;
      for (int z = low[2]; z < (known.max.z | 7) + 9; ++z)
        for (int y = low[1]; y < (known.max.y | 7) + 9; ++y)
          for (int x = low[0]; x < (known.max.x | 7) + 9; ++x) {
            // The border may lie outside the key range: a key would wrap around, an index must not.
            const VoxelKey key = detail::as_key({x, y, z});
            const bool is_key = detail::as_array(key) == std::array<int, 3>{x, y, z};
            if (!is_key) continue;
            const std::uint32_t index = table.layout().index(key);
            ASSERT_EQ(table.layout().key(index), (std::array<int, 3>{x, y, z}));
            const bool expected = table.contains(key) && !detail::blocks(grid.at(key), unknown);
            ASSERT_EQ(table.open(index), expected);
            open += expected ? 1 : 0;
          }
      EXPECT_GT(open, std::size_t{1000});
    }
}

// Compares voxels and radii, at places drawn from the table, with the grid.
// @return how many cells are open two cells around and more
std::size_t expect_equal(const OpenVoxels& table, const VoxelGrid& grid, UnknownPolicy unknown,
                         Random& random, int places = 500) {
  const auto is_open = [&](const std::array<int, 3>& voxel) {
    const VoxelKey key = detail::as_key(voxel);
    return detail::as_array(key) == voxel && table.contains(key) && !detail::blocks(grid.at(key), unknown);
  };
  std::size_t wide = 0;
  for (int i = 0; i < places; ++i) {
    std::array<int, 3> cell{};
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] = table.bounds_min(a) + 4 * random.below((table.bounds_max(a) + 1 - table.bounds_min(a)) / 4);
    const auto open_cells = [&](int around) {
      for (int x = cell[0] - 4 * around; x < cell[0] + 4 * around + 4; ++x)
        for (int y = cell[1] - 4 * around; y < cell[1] + 4 * around + 4; ++y)
          for (int z = cell[2] - 4 * around; z < cell[2] + 4 * around + 4; ++z)
            if (!is_open({x, y, z})) return false;
      return true;
    };
    const std::uint32_t index = table.layout().index(detail::as_key(cell));
    EXPECT_EQ(table.open(index), is_open(cell));
    const int radius = static_cast<int>(table.radius(index));
    EXPECT_TRUE(radius == 0 || open_cells(radius - 1));
    EXPECT_TRUE(radius == 15 || !open_cells(radius));
    wide += radius >= 2 ? 1 : 0;
  }
  return wide;
}

TEST(OpenVoxels, TellHowFarItIsOpenAroundACell) {
  Random random(11);
  for (const VoxelGrid& grid : grids())
    for (const UnknownPolicy unknown : kPolicies) {
      const OpenVoxels table = table_of(grid, unknown, kAllVoxels);
      if (!table.empty()) expect_equal(table, grid, unknown, random);
    }
  const VoxelGrid hall = hall_grid(7);
  EXPECT_GT(
      expect_equal(table_of(hall, UnknownPolicy::kBlock, kAllVoxels), hall, UnknownPolicy::kBlock, random),
      100U);
}

// Scans that change some voxels, uncover what was unknown, or forget a part; now and then beyond the table.
void expect_followed(UnknownPolicy unknown, std::uint64_t seed, bool whole) {
  Random random(seed);
  VoxelGrid grid = hall_grid(seed);
  const KeyBox window = windows(grid)[whole ? 0 : 1];
  OpenVoxels table = table_of(grid, unknown, window);
  KeyBox around = *grid.known_bounds();
  int followed = 0, outgrown = 0;
  for (int change = 0; change < 12; ++change) {
    const VoxelGrid before = grid;
    if (change % 3 == 2) around = grown(around, 16);
    const VoxelKey from = random.key_in(around);
    const KeyBox box = *intersection(
        {from, make_key(from.x + random.below(30), from.y + random.below(30), from.z + random.below(12))},
        around);
    const Occupancy state = detail::kStates[static_cast<std::size_t>(random.below(3))];
    for_each_key(box, [&](const VoxelKey& key) { grid.set(key, state); });
    if (random.one_in(3)) grid.fill({make_key(from.x & ~63, from.y & ~63, from.z & ~63), 6}, state);
    if (table.update(before, grid)) {
      ++followed;
    } else {
      ++outgrown;
      table = table_of(grid, unknown, window);
    }
    expect_equal(table, grid, unknown, random, 40);
  }
  EXPECT_GT(followed, 4);
  EXPECT_GT(outgrown, 0);
}

TEST(OpenVoxels, FollowAMapThatChangesAndGrows) {
  for (const bool whole : {true, false})
    for (const UnknownPolicy unknown : kPolicies)
      for (std::uint64_t seed = 1; seed <= (long_mode() ? 4 : 2); ++seed) {
        SCOPED_TRACE(seed);
        expect_followed(unknown, seed, whole);
      }
}

TEST(OpenVoxels, HaveRoomForWhatIsForgotten) {
  VoxelGrid grid = corner_grid(0, 5);
  const VoxelKey lone{80, 20, 20};  // alone in its cube of 64 voxels
  grid.set(lone, Occupancy::kFree);
  for (const UnknownPolicy unknown : kPolicies) {
    OpenVoxels table = table_of(grid, unknown, kAllVoxels);
    VoxelGrid after = grid;
    after.set(lone, Occupancy::kUnknown);
    EXPECT_TRUE(table.update(grid, after));
    EXPECT_EQ(table.open(table.layout().index(lone)), !detail::blocks(Occupancy::kUnknown, unknown));
  }
}

TEST(OpenVoxels, StayEmptyWhereThereIsNothingOrFarTooMuch) {
  VoxelGrid grid(0.1);
  EXPECT_TRUE(table_of(grid, UnknownPolicy::kBlock, kAllVoxels).empty());
  grid.set({1, 1, 1}, Occupancy::kFree);
  EXPECT_FALSE(table_of(grid, UnknownPolicy::kBlock, kAllVoxels).empty());
  grid.set({60000, 60000, 60000}, Occupancy::kFree);
  EXPECT_TRUE(table_of(grid, UnknownPolicy::kPass, kAllVoxels).empty());
  EXPECT_FALSE(table_of(grid, UnknownPolicy::kPass, kAllVoxels).contains({1, 1, 1}));
}

}  // namespace
}  // namespace frontlux::test
