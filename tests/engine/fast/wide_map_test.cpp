// Maps that are too wide for one table: the fast caster, sector by sector, against the walk of one ray.

#include "fast/map_tables.hpp"
#include "support/random.hpp"
#include "walk/walk.hpp"

#include <frontlux/ray_caster.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace frontlux::test {
namespace {

using detail::MapTables;
using detail::SectorPlan;

constexpr UnknownPolicy kPolicies[] = {UnknownPolicy::kBlock, UnknownPolicy::kPass};
constexpr int kGround = 32768;

// Two corridors of 4096 voxels that cross, with posts, specks and holes.
constexpr int kLength = 4096, kWidth = 64, kHeight = 24;
const KeyBox kAlongX{make_key(kGround, kGround + 2048, kGround),
                     make_key(kGround + kLength - 1, kGround + 2048 + kWidth - 1, kGround + kHeight - 1)};
const KeyBox kAlongY{make_key(kGround + 2048, kGround, kGround),
                     make_key(kGround + 2048 + kWidth - 1, kGround + kLength - 1, kGround + kHeight - 1)};

void change(VoxelGrid& grid, Random& random, int specks) {
  for (int i = 0; i < specks; ++i)
    grid.set(random.key_in(random.one_in(2) ? kAlongX : kAlongY),
             random.one_in(3) ? Occupancy::kUnknown : Occupancy::kOccupied);
}

VoxelGrid crossing(std::uint64_t seed) {
  VoxelGrid grid(0.2);
  for (const KeyBox& corridor : {kAlongX, kAlongY})
    for (int x = corridor.min.x; x < corridor.max.x; x += 8)
      for (int y = corridor.min.y; y < corridor.max.y; y += 8)
        for (int z = corridor.min.z; z < corridor.max.z; z += 8)
          grid.fill({make_key(x, y, z), 3}, Occupancy::kFree);
  Random random(seed);
  change(grid, random, 20'000);
  return grid;
}

// Queries that start around the borders of sectors, most of them shorter than tables reach beyond those.
struct Queries {
  std::vector<Ray> rays;
  std::vector<KeySegment> segments;

  Queries(const VoxelGrid& grid, int count, std::uint64_t seed) {
    Random random(seed);
    const int edge = SectorPlan::of(*grid.known_bounds())->edge;
    const int border = (kGround / edge + 1) * edge;
    const auto starts = [&](const KeyBox& corridor) {
      const bool along_x = corridor == kAlongX;
      const int at = border + random.below(3) * edge / 2 + random.below(40) - 20;
      const VoxelKey any = random.key_in(corridor);
      return along_x ? make_key(at, any.y, any.z) : make_key(any.x, at, any.z);
    };
    for (int i = 0; i < count; ++i) {
      const KeyBox& corridor = random.one_in(2) ? kAlongX : kAlongY;
      const VoxelKey from = starts(corridor);
      const int reach = random.one_in(8) ? 1500 : 150;
      const auto off = [&](int low, int high, int at) {
        return std::clamp(at + random.below(2 * reach) - reach, low - 8, high + 8);
      };
      const VoxelKey to =
          make_key(off(corridor.min.x, corridor.max.x, from.x), off(corridor.min.y, corridor.max.y, from.y),
                   off(corridor.min.z, corridor.max.z, from.z));
      segments.push_back({from, to});
      const Eigen::Vector3f center = grid.lattice().center(from);
      rays.push_back({center + random.point(-0.09, 0.09).cast<float>(), grid.lattice().center(to) - center,
                      random.one_in(20) ? -1.0 : 0.2 * reach});
    }
    rays.front().origin.x() = std::numeric_limits<float>::quiet_NaN();
    rays.back().origin.x() = 1e9F;
  }
};

// Counts what is answered otherwise than by a walk.
std::size_t differing(const RayCaster& caster, const VoxelGrid& grid, const Queries& queries) {
  std::size_t differ = 0;
  for (const UnknownPolicy unknown : kPolicies) {
    std::vector<Hit> hits(queries.rays.size());
    std::vector<std::uint8_t> visible(queries.segments.size(), 77);
    caster.cast(queries.rays, hits, unknown);
    caster.visible(queries.segments, visible, unknown);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const Hit hit = detail::walk_ray(grid, queries.rays[i], unknown);
      const bool same = hits[i].stop == hit.stop && hits[i].state == hit.state && hits[i].key == hit.key &&
                        std::memcmp(&hits[i].end, &hit.end, sizeof hit.end) == 0 &&
                        std::memcmp(&hits[i].entry, &hit.entry, sizeof hit.entry) == 0 &&
                        hits[i].distance == hit.distance;
      differ += same ? 0 : 1;
      differ += visible[i] == (detail::walk_visible(grid, queries.segments[i], unknown) ? 1 : 0) ? 0 : 1;
    }
  }
  return differ;
}

// So that the sectors get their tables.
void ask_often(const RayCaster& caster, const Queries& queries) {
  std::vector<std::uint8_t> visible(queries.segments.size());
  for (int i = 0; i < 100; ++i)
    for (const UnknownPolicy unknown : kPolicies) caster.visible(queries.segments, visible, unknown);
}

TEST(WideMap, IsAnsweredAsByAWalk) {
  VoxelGrid grid = crossing(1);
  ASSERT_EQ(MapTables(grid, UnknownPolicy::kBlock).whole(), nullptr);
  const auto caster = make_ray_caster(grid);
  const std::size_t bytes = caster->memory_bytes();
  const Queries queries(grid, 6'000, 2);
  EXPECT_EQ(differing(*caster, grid, queries), 0U);
  EXPECT_LT(caster->memory_bytes(), bytes + (std::size_t{1} << 20U));
  ask_often(*caster, queries);
  EXPECT_GT(caster->memory_bytes(), bytes + (std::size_t{1} << 20U));
  EXPECT_EQ(differing(*caster, grid, queries), 0U);
  Random random(3);
  for (int update = 0; update < 3; ++update) {
    change(grid, random, 300);
    caster->update(grid);
    EXPECT_EQ(differing(*caster, grid, queries), 0U);
  }
}

TEST(WideMap, IsDividedSoThatWhatStartsInASectorEndsInItsTable) {
  for (const int height : {24, 600}) {
    const auto plan = SectorPlan::of({make_key(0, 0, 100), make_key(65535, 65535, 100 + height)});
    ASSERT_TRUE(plan);
    Random random(4);
    for (int i = 0; i < 1000; ++i) {
      const VoxelKey key = random.key_in(kAllVoxels);
      const KeyBox window = plan->window(plan->sector_of(key));
      const KeyBox around = grown({key, key}, SectorPlan::kBeyond, SectorPlan::kBeyond, 0);
      EXPECT_EQ(intersection(window, around), around);
      EXPECT_EQ(window.min.x % 8, 0);
      EXPECT_EQ(window.max.y % 8, 7);
    }
  }
  EXPECT_FALSE(SectorPlan::of({{0, 0, 0}, {65535, 65535, 2000}}));
}

TEST(WideMap, HasATableOnlyWhereItIsAskedOften) {
  const VoxelGrid grid = crossing(5);
  const MapTables tables(grid, UnknownPolicy::kBlock);
  const std::uint32_t sector = tables.sector_of(kAlongX.min);
  EXPECT_FALSE(tables.is_worth_a_table(sector, 1000));
  EXPECT_EQ(tables.memory_bytes(), 0U);
  EXPECT_TRUE(tables.is_worth_a_table(sector, 100'000));
  ASSERT_NE(tables.sector(sector), nullptr);
  EXPECT_TRUE(tables.sector(sector)->contains(kAlongX.min));
  EXPECT_FALSE(tables.sector(sector)->contains(kAlongX.max));
}

// At the next moment it is still known to be asked often, and what was its table takes memory.
TEST(WideMap, CountsTablesThatWaitForTheirNextMoment) {
  const VoxelGrid grid = crossing(5);
  auto tables = std::make_unique<MapTables>(grid, UnknownPolicy::kBlock);
  const std::uint32_t sector = tables->sector_of(kAlongX.min);
  EXPECT_TRUE(tables->is_worth_a_table(sector, 100'000));
  ASSERT_NE(tables->sector(sector), nullptr);
  const std::size_t bytes = tables->memory_bytes();
  const MapTables later(grid, *tables);
  tables.reset();
  EXPECT_EQ(later.memory_bytes(), bytes);
  EXPECT_TRUE(later.is_worth_a_table(sector, 1));
  ASSERT_NE(later.sector(sector), nullptr);
  EXPECT_EQ(later.memory_bytes(), bytes);
}

TEST(WideMap, ThatGrowsGoesFromOneTableToSectorsAndToNone) {
  VoxelGrid grid(0.2);
  grid.set(make_key(kGround, kGround, kGround), Occupancy::kFree);
  const MapTables small(grid, UnknownPolicy::kPass);
  ASSERT_NE(small.whole(), nullptr);
  EXPECT_FALSE(small.whole()->empty());
  grid.set(make_key(kGround + 9000, kGround + 9000, kGround), Occupancy::kFree);
  const MapTables wide(grid, small);
  EXPECT_EQ(wide.whole(), nullptr);
  grid.set(make_key(kGround, kGround, kGround + 9000), Occupancy::kFree);
  const MapTables high(grid, wide);
  ASSERT_NE(high.whole(), nullptr);
  EXPECT_TRUE(high.whole()->empty());
}

// A change may be told as a block that is far larger and higher than what was known in it.
TEST(WideMap, IsNoHigherForWhatIsForgotten) {
  VoxelGrid grid(0.2);
  const VoxelKey here = make_key(kGround, kGround, kGround),
                 lone = make_key(kGround + 9000, kGround, kGround);
  for (const VoxelKey& key : {here, lone, make_key(kGround, kGround + 9000, kGround)})
    grid.set(key, Occupancy::kFree);
  const MapTables wide(grid, UnknownPolicy::kPass);
  ASSERT_EQ(wide.whole(), nullptr);
  const std::uint32_t sector = wide.sector_of(here);
  EXPECT_TRUE(wide.is_worth_a_table(sector, 100'000));
  grid.set(lone, Occupancy::kUnknown);
  const MapTables later(grid, wide);
  ASSERT_EQ(later.whole(), nullptr);
  EXPECT_TRUE(later.is_worth_a_table(sector, 1)) << "it is still known to be asked often";
}

}  // namespace
}  // namespace frontlux::test
