// The map in motion: surfaces stay in it, what is gone does not.

#include "mapping/conservative_map.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <limits>

namespace frontlux::planner::detail {
namespace {

using test::key_at;
using Keys = std::vector<VoxelKey>;

constexpr float kNothing = std::numeric_limits<float>::infinity();

// The map and what is made of it, with a sensor in the middle of a voxel that measures along x.
struct Maps {
  Mapping map{{.resolution = 0.3}};
  ConservativeMap conservative{map.grid()};
  Keys told, changed;
  const VoxelKey place = key_at(10, 0, 0), before = key_at(9, 0, 0);

  // A ray at a height over the middle of the voxels [m].
  void scan(float range, float height, int times) {
    const Scan scan{{0.15F, 0.15F, 0.15F + height}, 10.0, {Eigen::Vector3f::UnitX()}, {range}};
    for (int i = 0; i < times; ++i) {
      const MapChange change = map.insert(scan);
      changed.insert(changed.end(), change.keys.begin(), change.keys.end());
      static_cast<void>(conservative.insert(scan, map, change));
    }
  }
  void update(const Keys& robots = {}) {
    told = conservative.update(map.grid(), changed, robots);
    changed.clear();
  }
  [[nodiscard]] Occupancy at(const VoxelKey& key) const { return conservative.grid().at(key); }
};

TEST(ConservativeMap, IsTheMapWithoutHits) {
  Maps maps;
  maps.scan(kNothing, 0.0F, 1);
  maps.update();
  EXPECT_EQ(maps.at(maps.place), Occupancy::kFree);
  EXPECT_EQ(maps.at(key_at(10, 1, 0)), Occupancy::kUnknown);
  maps.scan(3.0F, 0.0F, 3);
  maps.update();
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied);
  EXPECT_EQ(maps.at(maps.before), Occupancy::kFree);
}

// A wall by which rays pass.
TEST(ConservativeMap, KeepsWhatRaysPassBeside) {
  Maps maps;
  maps.scan(3.0F, 0.0F, 2);
  maps.scan(kNothing, 0.1F, 20);
  maps.update();
  ASSERT_EQ(maps.map.grid().at(maps.place), Occupancy::kFree);
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied);
}

// A door, or somebody who has gone on.
TEST(ConservativeMap, LosesWhatRaysPassThrough) {
  Maps maps;
  maps.scan(3.0F, 0.0F, 2);
  maps.update();
  maps.scan(kNothing, 0.0F, 5);
  maps.update();
  ASSERT_EQ(maps.map.grid().at(maps.place), Occupancy::kFree);
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied);
  maps.scan(kNothing, 0.0F, 6);
  maps.update();
  EXPECT_EQ(maps.at(maps.place), Occupancy::kFree);
  EXPECT_EQ(maps.told, Keys{maps.place});
}

// Though the map does not change.
TEST(ConservativeMap, ForgetsWhatIsSaidToBeGone) {
  Maps maps;
  maps.scan(3.0F, 0.0F, 3);
  maps.update();
  static_cast<void>(maps.map.mark_free(Keys{maps.place}));
  maps.changed = {maps.place};
  maps.update();
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied);
  maps.conservative.forget(Keys{maps.place, maps.before});
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied) << "until the next update";
  maps.update();
  EXPECT_EQ(maps.at(maps.place), Occupancy::kFree);
  EXPECT_EQ(maps.told, Keys{maps.place});
  maps.scan(kNothing, 0.0F, 1);  // passes where nothing is known to have been
  maps.scan(3.0F, 0.0F, 2);
  maps.update();
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied) << "something is there again";
}

TEST(ConservativeMap, GetsWhatIsHitInFreeSpace) {
  Maps maps;
  maps.scan(kNothing, 0.0F, 10);
  maps.update();
  maps.scan(3.0F, 0.0F, 2);
  maps.update();
  ASSERT_EQ(maps.map.grid().at(maps.place), Occupancy::kFree);
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied);
  EXPECT_EQ(maps.told, Keys{maps.place});
}

TEST(ConservativeMap, IsFreeWhereARobotIsAsLongAsItIsThere) {
  Maps maps;
  maps.scan(3.0F, 0.0F, 2);
  maps.update({maps.place});
  EXPECT_EQ(maps.told, Keys{maps.place});
  EXPECT_EQ(maps.at(maps.place), Occupancy::kFree);
  maps.update();
  EXPECT_EQ(maps.told, Keys{maps.place});
  EXPECT_EQ(maps.at(maps.place), Occupancy::kOccupied);
  maps.update({maps.place});
  maps.scan(kNothing, 0.0F, 12);
  maps.update();
  EXPECT_EQ(maps.at(maps.place), Occupancy::kFree);
}

TEST(ConservativeMap, IsWhatItsRuleSaysAfterRandomScans) {
  int differs = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const KeyBox box{key_at(-6, -6, -6), key_at(6, 6, 6)};
    Mapping map({.resolution = 0.3, .bounds = box});
    ConservativeMap conservative(map.grid());
    HitPoints points(map.grid());
    std::vector<Eigen::Vector3f> directions;
    for (int i = 0; i < 60; ++i) directions.push_back(random.point(-1.0, 1.0).cast<float>().normalized());
    VoxelGrid map_before = map.grid();
    for (int step = 0; step < 20; ++step) {
      Keys changed;
      for (int i = random.below(4); i >= 0; --i) {
        Scan scan{Eigen::Vector3f::Zero(), 5.0, directions, {}};
        for (std::size_t ray = 0; ray < directions.size(); ++ray)
          scan.ranges.push_back(random.one_in(3) ? 1.5F : kNothing);
        const MapChange change = map.insert(scan);
        changed.insert(changed.end(), change.keys.begin(), change.keys.end());
        EXPECT_EQ(conservative.insert(scan, map, change), points.insert(scan, map, change));
      }
      // What has changed back is no change.
      std::erase_if(changed, [&](const VoxelKey& key) { return map.grid().at(key) == map_before.at(key); });
      map_before = map.grid();
      const VoxelKey robot = random.key_in(box);
      const VoxelGrid before = conservative.grid();
      Keys told = conservative.update(map.grid(), changed, Keys{robot});
      told.insert(told.end(), changed.begin(), changed.end());
      test::sort(told);
      for (const VoxelKey& key : test::keys_of(box)) {
        Occupancy expected = map.grid().at(key);
        if (expected == Occupancy::kFree && points.is_solid(key)) {
          expected = Occupancy::kOccupied;
          ++differs;
        }
        if (expected == Occupancy::kOccupied && key == robot) expected = Occupancy::kFree;
        ASSERT_EQ(conservative.grid().at(key), expected);
        EXPECT_TRUE(expected == before.at(key) || std::ranges::binary_search(told, key));
      }
    }
  }
  EXPECT_GT(differs, 100);
}

}  // namespace
}  // namespace frontlux::planner::detail
