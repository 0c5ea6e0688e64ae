#include "tour/space_behind.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

namespace frontlux::planner::detail {
namespace {

using Keys = std::vector<VoxelKey>;

constexpr KeyBox kBounds{{1000, 1000, 1000}, {1015, 1011, 1008}};

// By the definition: so many times all neighbours of what is reached.
bool lead_to_space_by_hand(const VoxelGrid& grid, const Keys& frontiers, int half, int steps) {
  std::set<VoxelKey> reached(frontiers.begin(), frontiers.end());
  const auto is_unknown = [&](const VoxelKey& key) {
    return kBounds.contains(key) && grid.at(key) == Occupancy::kUnknown;
  };
  for (int step = 0; step < steps; ++step) {
    Keys added;
    for_each_key(kBounds, [&](const VoxelKey& key) {
      const bool beside = std::ranges::any_of(reached, [&](const VoxelKey& from) {
        return std::abs(key.x - from.x) + std::abs(key.y - from.y) + std::abs(key.z - from.z) == 1;
      });
      if (is_unknown(key) && beside && !reached.contains(key)) added.push_back(key);
    });
    for (const VoxelKey& key : added) {
      const bool is_middle = all_of(grown({key, key}, half), [&](const VoxelKey& in) {
        return is_unknown(in) && std::ranges::find(frontiers, in) == frontiers.end();
      });
      if (is_middle) return true;
      reached.insert(key);
    }
  }
  return false;
}

TEST(SpaceBehind, IsFoundAsByTheDefinition) {
  test::Random random(51);
  int found = 0, none = 0;
  for (int round = 0; round < 300; ++round) {
    VoxelGrid grid(0.1);
    const int boxes = random.below(60);
    for (int i = 0; i < boxes; ++i) {
      const VoxelKey a = random.key_in(kBounds);
      test::fill(grid, grown({a, a}, random.below(2), random.below(2), random.below(4)),
                 random.one_in(2) ? Occupancy::kFree : Occupancy::kOccupied);
    }
    Keys frontiers;
    const VoxelKey first = random.key_in(kBounds);
    for_each_key(grown({first, first}, 1, 1, 0), [&](const VoxelKey& key) {
      if (kBounds.contains(key) && grid.at(key) == Occupancy::kUnknown) frontiers.push_back(key);
    });
    test::sort(frontiers);
    const int half = 1 + random.below(2), steps = random.below(7);
    const bool leads = lead_to_space(grid, kBounds, frontiers, half, steps);
    EXPECT_EQ(leads, lead_to_space_by_hand(grid, frontiers, half, steps)) << round;
    ++(leads ? found : none);
  }
  EXPECT_GT(found, 50);
  EXPECT_GT(none, 50);
}

TEST(SpaceBehind, EndsAtTheEndOfTheKeyRange) {
  const VoxelGrid grid(0.1);
  const Keys corner{{0, 0, 0}};
  EXPECT_TRUE(lead_to_space(grid, kAllVoxels, corner, 2, 3)) << "a cube is cut off there";
  EXPECT_FALSE(lead_to_space(grid, kAllVoxels, corner, 2, 2));
  EXPECT_FALSE(lead_to_space(grid, kAllVoxels, {}, 2, 9));
}

}  // namespace
}  // namespace frontlux::planner::detail
