// The map in motion: surfaces stay in it, stray returns do not.

#include "exploration/conservative_map.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <cstdlib>
#include <set>

namespace frontlux::planner::detail {
namespace {

using test::key_at;
using Keys = std::vector<VoxelKey>;

constexpr int kLeast = ConservativeMap::kLeastSurface;

// The map and what is made of it.
struct Maps {
  VoxelGrid map{0.1};
  ConservativeMap conservative{map};
  Keys told;

  void set(const Keys& keys, Occupancy state) {
    for (const VoxelKey& key : keys) map.set(key, state);
    told = conservative.update(map, keys);
    test::sort(told);
  }
  [[nodiscard]] Occupancy at(const VoxelKey& key) const { return conservative.grid().at(key); }
};

Keys row(int length) { return test::keys_of({key_at(0, 0, 0), key_at(length - 1, 0, 0)}); }

TEST(ConservativeMap, KeepsSurfacesOfWhichAVoxelIsStillOccupied) {
  Maps maps;
  maps.set(row(3), Occupancy::kOccupied);
  maps.set({key_at(0, 0, 0), key_at(1, 0, 0)}, Occupancy::kFree);
  for (const VoxelKey& key : row(3)) EXPECT_EQ(maps.at(key), Occupancy::kOccupied);
  maps.set({key_at(2, 0, 0)}, Occupancy::kFree);
  EXPECT_EQ(maps.told, row(3));
  for (const VoxelKey& key : row(3)) EXPECT_EQ(maps.at(key), Occupancy::kFree);
}

TEST(ConservativeMap, KeepsLargeSurfacesThatAreAllFree) {
  for (const int length : {1, kLeast - 1, kLeast, 2 * kLeast}) {
    Maps maps;
    maps.set(row(length), Occupancy::kOccupied);
    maps.set(row(length), Occupancy::kFree);
    for (const VoxelKey& key : row(length))
      EXPECT_EQ(maps.at(key), length < kLeast ? Occupancy::kFree : Occupancy::kOccupied) << length;
  }
}

TEST(ConservativeMap, HangsVoxelsTogetherByCornersButNotOverGaps) {
  Maps maps;
  maps.set({key_at(0, 0, 0), key_at(1, 1, 1), key_at(3, 1, 1)}, Occupancy::kOccupied);
  maps.set({key_at(0, 0, 0)}, Occupancy::kFree);
  EXPECT_EQ(maps.at(key_at(0, 0, 0)), Occupancy::kOccupied);
  maps.set({key_at(1, 1, 1)}, Occupancy::kFree);
  EXPECT_EQ(maps.at(key_at(0, 0, 0)), Occupancy::kFree);
  EXPECT_EQ(maps.at(key_at(1, 1, 1)), Occupancy::kFree);
  EXPECT_EQ(maps.at(key_at(3, 1, 1)), Occupancy::kOccupied);
}

// Also if its neighbour has become free meanwhile.
TEST(ConservativeMap, IsFreeWhereARobotIsAsLongAsItIsThere) {
  Maps maps;
  const VoxelKey own = key_at(0, 0, 0), beside = key_at(1, 0, 0);
  maps.set({own, beside}, Occupancy::kOccupied);
  EXPECT_EQ(maps.conservative.update(maps.map, {}, Keys{own}), Keys{own});
  EXPECT_EQ(maps.at(own), Occupancy::kFree);
  EXPECT_EQ(maps.at(beside), Occupancy::kOccupied);
  EXPECT_EQ(maps.conservative.update(maps.map, {}, {}), Keys{own});
  EXPECT_EQ(maps.at(own), Occupancy::kOccupied);
  maps.map.set(beside, Occupancy::kFree);
  static_cast<void>(maps.conservative.update(maps.map, Keys{beside}, Keys{own}));
  EXPECT_EQ(maps.at(beside), Occupancy::kOccupied);
  maps.set({own}, Occupancy::kFree);
  EXPECT_EQ(maps.at(own), Occupancy::kFree);
  EXPECT_EQ(maps.at(beside), Occupancy::kFree);
}

TEST(ConservativeMap, ReachesToTheEndOfTheKeyRange) {
  Maps maps;
  const VoxelKey last = make_key(0xFFFF, 0, 0xFFFF);
  maps.set({last}, Occupancy::kOccupied);
  maps.set({last}, Occupancy::kFree);
  EXPECT_EQ(maps.at(last), Occupancy::kFree);
}

bool touch(const VoxelKey& a, const VoxelKey& b) {
  return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && std::abs(a.z - b.z) <= 1;
}

// Of the voxels in `closed` all that hang together with one.
std::set<VoxelKey> plain_group(const std::set<VoxelKey>& closed, const VoxelKey& key) {
  std::set<VoxelKey> group = {key};
  for (bool grows = true; grows;) {
    grows = false;
    for (const VoxelKey& other : closed)
      if (std::ranges::any_of(group, [&](const VoxelKey& member) { return touch(member, other); }))
        grows = group.insert(other).second || grows;
  }
  return group;
}

TEST(ConservativeMap, IsWhatItsRuleSaysAfterRandomChanges) {
  int surfaces = 0, strays = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const KeyBox box{key_at(-3, -3, 5), key_at(3, 3, 9)};
    Maps maps;
    std::set<VoxelKey> closed;
    for (int edit = 0; edit < 30; ++edit) {
      Keys changed;
      for (int i = 0; i < 12; ++i) {
        const VoxelKey key = random.key_in(box);
        maps.map.set(key, random.one_in(4) ? Occupancy::kOccupied : Occupancy::kFree);
        changed.push_back(key);
      }
      test::sort(changed);
      const auto is_occupied = [&](const VoxelKey& key) { return maps.map.at(key) == Occupancy::kOccupied; };
      std::ranges::copy_if(changed, std::inserter(closed, closed.end()), is_occupied);
      Keys opened;
      for (const VoxelKey& key : closed) {
        const std::set<VoxelKey> group = plain_group(closed, key);
        if (group.size() < kLeast && std::ranges::none_of(group, is_occupied)) opened.push_back(key);
      }
      for (const VoxelKey& key : opened) closed.erase(key);
      const VoxelGrid before = maps.conservative.grid();
      const VoxelKey robot = random.key_in(box);
      Keys told = maps.conservative.update(maps.map, changed, Keys{robot});
      told.insert(told.end(), changed.begin(), changed.end());
      test::sort(told);
      for (const VoxelKey& key : test::keys_of(box)) {
        const bool is_closed = closed.contains(key) && key != robot;
        const Occupancy otherwise = closed.contains(key) ? Occupancy::kFree : maps.map.at(key);
        ASSERT_EQ(maps.at(key), is_closed ? Occupancy::kOccupied : otherwise);
        EXPECT_TRUE(maps.at(key) == before.at(key) || std::ranges::binary_search(told, key));
      }
      strays += static_cast<int>(opened.size());
      surfaces += static_cast<int>(std::ranges::count_if(closed, std::not_fn(is_occupied)));
    }
  }
  EXPECT_GT(strays, 30);
  EXPECT_GT(surfaces, 30);
}

}  // namespace
}  // namespace frontlux::planner::detail
