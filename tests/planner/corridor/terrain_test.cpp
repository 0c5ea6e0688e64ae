// Terrain against its definition, column by column.

#include "corridor/terrain.hpp"

#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

bool is(const VoxelGrid& grid, const KeyBox& box, Occupancy state, int x, int y, int z) {
  const bool inside = x >= box.min.x && x <= box.max.x && y >= box.min.y && y <= box.max.y &&
                      z >= box.min.z && z <= box.max.z;
  return inside && grid.at(make_key(x, y, z)) == state;
}

bool is_ground(const VoxelGrid& grid, const Terrain::Options& options, int x, int y, int z) {
  return is(grid, options.box, Occupancy::kOccupied, x, y, z) &&
         (!options.depth || !is(grid, options.box, Occupancy::kOccupied, x, y, z + 1));
}

bool is_hole(const VoxelGrid& grid, const Terrain::Options& options, int x, int y, int z) {
  if (!is(grid, options.box, Occupancy::kFree, x, y, z)) return false;
  for (int d = -options.below; d <= options.above; ++d)
    if (is(grid, options.box, Occupancy::kOccupied, x, y, z + d)) return false;
  return true;
}

bool is_carried(const VoxelGrid& grid, const Terrain::Options& options, const VoxelKey& floor) {
  if (!options.box.contains(floor)) return false;
  const auto no_hole_under_it = [&](const auto& is_one) {
    for (int x = -options.half_x; x <= options.half_x; ++x)
      for (int y = -options.half_y; y <= options.half_y; ++y)
        if (is_one(floor.x + x, floor.y + y)) return false;
    return true;
  };
  const auto hole = [&](int x, int y) { return is_hole(grid, options, x, y, floor.z); };
  const auto holes_all_around = [&] {
    for (int x = floor.x - options.reach; x <= floor.x + options.reach; ++x)
      for (int y = floor.y - options.reach; y <= floor.y + options.reach; ++y) {
        const bool inside = x >= options.box.min.x && x <= options.box.max.x && y >= options.box.min.y &&
                            y <= options.box.max.y;
        if (inside && !hole(x, y)) return false;
      }
    return true;
  };
  for (const KeyBox& box : options.exempt)
    if (box.contains(floor))
      return options.depth ? no_hole_under_it([&](int x, int y) {
        return hole(x, y) && is(grid, options.box, Occupancy::kFree, x, y, floor.z - 1);
      })
                           : !holes_all_around();
  bool near = false;
  for (int x = -options.reach; x <= options.reach; ++x)
    for (int y = -options.reach; y <= options.reach; ++y)
      for (int z = -options.depth.value_or(0); z <= 0; ++z)
        near = near || is_ground(grid, options, floor.x + x, floor.y + y, floor.z + z);
  return near && no_hole_under_it(hole);
}

// Layers and boxes of up to two words a column, at both ends of the key range and in its middle.
TEST(Terrain, EqualsBruteForceAfterRandomChanges) {
  std::size_t with = 0, without = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const int height = seed % 3 == 0 ? 1 : 1 + random.below(seed % 3 == 1 ? 12 : 80);
    const VoxelKey corner = make_key(random.one_in(2) ? 0 : 32700, random.one_in(2) ? 65536 - 20 : 32700,
                                     random.one_in(3) ? 65536 - height : 100);
    Terrain::Options options{
        {corner, make_key(corner.x + random.below(20), corner.y + random.below(20), corner.z + height - 1)}};
    options.half_x = random.below(3);
    options.half_y = random.below(3);
    options.reach = random.below(3);
    if (seed % 3 != 0) {
      options.above = random.below(3);
      options.below = random.below(4);
      options.depth = random.below(3);
    }
    if (random.one_in(2))
      options.exempt = {{corner, make_key(corner.x + 3, corner.y + 2, std::min(corner.z + 2, 65535))}};
    VoxelGrid grid(0.1);
    Terrain terrain(options);
    for (int round = 0; round < 4; ++round) {
      std::vector<VoxelKey> changed;
      for_each_key(options.box, [&](const VoxelKey& key) {
        if (!random.one_in(round == 0 ? 2 : 40)) return;
        grid.set(key, random.one_in(9) ? Occupancy::kFree : static_cast<Occupancy>(2 * random.below(2)));
        changed.push_back(key);
      });
      round == 0 ? terrain.read(grid) : terrain.read(grid, changed);
      for_each_key(grown(options.box, 1), [&](const VoxelKey& key) {
        const bool expected = is_carried(grid, options, key);
        ASSERT_EQ(terrain.carries(key), expected) << "seed " << seed << ", round " << round;
        (expected ? with : without) += 1;
      });
    }
  }
  EXPECT_GT(with, 2'000U);
  EXPECT_GT(without, 2'000U);
}

TEST(Terrain, CarriesNowhereInAnUnknownMap) {
  Terrain terrain({{{5, 5, 0}, {9, 9, 9}}});
  terrain.read(VoxelGrid(0.1));
  EXPECT_FALSE(terrain.carries({7, 7, 0}));
}

}  // namespace
}  // namespace frontlux::planner::detail
