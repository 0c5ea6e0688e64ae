// Ground against its definition, column by column.

#include "corridor/ground.hpp"

#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

bool has_ground(const VoxelGrid& grid, const Ground::Options& options, const VoxelKey& key) {
  for (const KeyBox& box : options.exempt)
    if (box.contains({key.x, key.y, box.min.z})) return true;
  bool near = false;
  const KeyBox layer{{options.box.min.x, options.box.min.y, *options.layer},
                     {options.box.max.x, options.box.max.y, *options.layer}};
  for_each_key(layer, [&](const VoxelKey& floor) {
    const int dx = std::abs(floor.x - key.x), dy = std::abs(floor.y - key.y);
    if (grid.at(floor) == Occupancy::kOccupied) near = near || std::max(dx, dy) <= options.reach;
  });
  return near && all_of(layer, [&](const VoxelKey& floor) {
           return std::abs(floor.x - key.x) > options.half_x || std::abs(floor.y - key.y) > options.half_y ||
                  grid.at(floor) != Occupancy::kFree;
         });
}

TEST(Ground, EqualsBruteForceAfterRandomChanges) {
  std::size_t with = 0, without = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const VoxelKey corner =
        make_key(random.one_in(2) ? 0 : 32700, random.one_in(2) ? 65536 - 24 : 32700, 100);
    Ground::Options options{{corner, make_key(corner.x + random.below(24), corner.y + random.below(24), 110)},
                            std::uint16_t{99}};
    options.half_x = random.below(3);
    options.half_y = random.below(3);
    options.reach = random.below(3);
    if (random.one_in(2)) options.exempt = {{corner, make_key(corner.x + 3, corner.y + 2, 105)}};
    const KeyBox floors{{corner.x, corner.y, 98}, {options.box.max.x, options.box.max.y, 99}};
    VoxelGrid grid(0.1);
    Ground ground(options);
    for (int round = 0; round < 4; ++round) {
      std::vector<VoxelKey> changed;
      for_each_key(floors, [&](const VoxelKey& key) {
        if (!random.one_in(round == 0 ? 2 : 40)) return;
        grid.set(key, random.one_in(9) ? Occupancy::kFree : static_cast<Occupancy>(2 * random.below(2)));
        changed.push_back(key);
      });
      round == 0 ? ground.read(grid) : ground.read(grid, changed);
      for_each_key({corner, {options.box.max.x, options.box.max.y, corner.z}}, [&](const VoxelKey& key) {
        const bool expected = has_ground(grid, options, key);
        ASSERT_EQ(ground.carries(key), expected) << "seed " << seed << ", round " << round;
        (expected ? with : without) += 1;
      });
    }
  }
  EXPECT_GT(with, 2'000U);
  EXPECT_GT(without, 2'000U);
}

TEST(Ground, CarriesNowhereWithoutALayer) {
  Ground ground({{{5, 5, 0}, {9, 9, 9}}, std::nullopt});
  ground.read(VoxelGrid(0.1));
  EXPECT_FALSE(ground.carries({7, 7, 0}));
}

}  // namespace
}  // namespace frontlux::planner::detail
