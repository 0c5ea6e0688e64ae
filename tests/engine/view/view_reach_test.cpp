// The integer form of the field of view, the index of targets and the drawing of ranks, each against its
// definition.

#include "view/view_reach.hpp"

#include "view/rank_draw.hpp"
#include "support/random.hpp"
#include "view/target_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

namespace frontlux::test {
namespace {

using detail::CellBox;
using detail::TargetIndex;
using detail::ViewReach;

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kMiddle = 32768;

std::uint16_t key(int k) { return static_cast<std::uint16_t>(k); }

// Ranges and slopes that put voxel centres exactly on the border, as far as rounding lets them.
std::vector<std::pair<FieldOfView, double>> views() {
  using enum FieldOfView::Shape;
  std::vector<std::pair<FieldOfView, double>> views;
  for (const double resolution : {0.3, 0.1, 0.25, 0.37})
    for (const double cells : {1.0, 5.0, 13.0, 20.0, 24.99})
      for (const double slope : {0.75, 1.0, std::tan(20 * kDegree), std::tan(36 * kDegree)}) {
        const double angle = 2 * std::atan(slope);
        views.push_back({{kSpinning, 0.0, angle, cells * resolution}, resolution});
        views.push_back({{kPyramid, 1.0, angle, cells * resolution}, resolution});
        views.push_back({{kCone, angle, 0.0, cells * resolution}, resolution});
      }
  return views;
}

TEST(ViewReach, IsTheFieldOfViewToTheLastBorder) {
  for (const auto& [view, resolution] : views()) {
    const ViewReach reach(view, resolution, 0);
    const VoxelKey from{key(kMiddle), key(kMiddle), key(kMiddle)};
    const int far = static_cast<int>(view.max_range / resolution) + 3;
    for (int dx = -far; dx <= far; ++dx)
      for (int dy = -far; dy <= far; ++dy)
        for (int dz = -far; dz <= far; ++dz) {
          const VoxelKey to{key(kMiddle + dx), key(kMiddle + dy), key(kMiddle + dz)};
          const bool expected =
              view.contains_at_some_yaw({dx * resolution, dy * resolution, dz * resolution});
          ASSERT_EQ(reach.contains(from, to), expected) << dx << ' ' << dy << ' ' << dz;
        }
    EXPECT_FALSE(reach.contains({0, 0, 0}, {65535, 65535, 65535}));
    EXPECT_FALSE(reach.contains({0, 9, 9}, {65535, 9, 9}));
  }
}

TEST(ViewReach, BoxesAreRejectedOnlyIfNothingInThemIsInView) {
  Random random(1);
  std::size_t rejected = 0, accepted = 0;
  for (const auto& [view, resolution] : views()) {
    const ViewReach reach(view, resolution, 0);
    for (int i = 0; i < 300; ++i) {
      const auto box = [&](int spread) {
        CellBox b;
        for (std::size_t a = 0; a < 3; ++a) {
          b.min[a] = kMiddle + random.below(2 * spread + 1) - spread;
          b.max[a] = b.min[a] + random.below(5);
        }
        return b;
      };
      const CellBox a = box(0), b = box(30);
      const auto pick = [&](const CellBox& c) {
        const auto along = [&](std::size_t x) {
          return key(c.min[x] + random.below(c.max[x] - c.min[x] + 1));
        };
        return VoxelKey{along(0), along(1), along(2)};
      };
      const bool may = reach.may_contain(a, b);
      for (int pair = 0; pair < 20; ++pair) ASSERT_TRUE(may || !reach.contains(pick(a), pick(b)));
      (may ? accepted : rejected) += 1;
    }
  }
  EXPECT_GT(rejected, 1000U);
  EXPECT_GT(accepted, 1000U);
}

TEST(ViewReach, BinsCountFromAzimuthZeroUpwards) {
  EXPECT_EQ(detail::azimuth_bin(0.0, 36), 0);
  EXPECT_EQ(detail::azimuth_bin(9.999 * kDegree, 36), 0);
  EXPECT_EQ(detail::azimuth_bin(10.001 * kDegree, 36), 1);
  EXPECT_EQ(detail::azimuth_bin(-0.001 * kDegree, 36), 35);
  EXPECT_EQ(detail::azimuth_bin(-1e-300, 36), 35);
  EXPECT_EQ(detail::azimuth_bin(std::numbers::pi, 36), 18);
  EXPECT_EQ(detail::azimuth_bin(-std::numbers::pi, 36), 18);
  EXPECT_EQ(detail::azimuth_bin(745 * kDegree, 36), 2);
  EXPECT_EQ(detail::azimuth_bin(1.0, 1), 0);
}

TEST(CellCode, SortsByCubesAndIsReversible) {
  Random random(2);
  for (int i = 0; i < 10'000; ++i) {
    const VoxelKey a{key(random.below(65536)), key(random.below(65536)), key(random.below(65536))};
    const std::uint64_t code = detail::cell_code(a);
    ASSERT_EQ(detail::cell_of_code(code), a);
    const VoxelKey cube = detail::cell_of_code(code >> detail::kBlockCode << detail::kBlockCode);
    ASSERT_EQ(cube, (VoxelKey{key(a.x & ~7), key(a.y & ~7), key(a.z & ~7)}));
    const VoxelKey region = detail::cell_of_code(code >> detail::kRegionCode << detail::kRegionCode);
    ASSERT_EQ(region, (VoxelKey{key(a.x & ~63), key(a.y & ~63), key(a.z & ~63)}));
  }
}

TEST(TargetIndex, ListsAllThatIsInReach) {
  Random random(3);
  std::vector<VoxelKey> targets{{0, 0, 0}, {65535, 65535, 65535}};
  for (int i = 0; i < 4000; ++i)
    targets.push_back(
        {key(kMiddle + random.below(150)), key(kMiddle + random.below(150)), key(random.below(80))});
  targets.push_back(targets.front());
  const TargetIndex index(targets);
  EXPECT_EQ(index.codes().size(), std::set<VoxelKey>(targets.begin(), targets.end()).size());
  std::uint32_t next = 0;
  for (const TargetIndex::Cube& cube : index.cubes()) {
    ASSERT_EQ(cube.begin, next);
    next = cube.end;
    for (std::uint32_t t = cube.begin; t < cube.end; ++t) {
      const VoxelKey k = detail::cell_of_code(index.codes()[t]);
      ASSERT_TRUE(cube.box.min[0] <= k.x && k.x <= cube.box.max[0] && cube.box.min[2] <= k.z &&
                  k.z <= cube.box.max[2]);
    }
  }
  EXPECT_EQ(next, index.codes().size());

  const ViewReach reach({FieldOfView::Shape::kSpinning, 0.0, 1.2, 6.0}, 0.3, 0);
  std::vector<std::uint32_t> cubes;
  for (int i = 0; i < 100; ++i) {
    const VoxelKey from{key(kMiddle + random.below(150)), key(kMiddle + random.below(150)),
                        key(random.below(80))};
    index.list_cubes(reach, CellBox::of(from), cubes);
    EXPECT_TRUE(std::is_sorted(cubes.begin(), cubes.end()));
    EXPECT_LT(cubes.size(), index.cubes().size());
    std::set<VoxelKey> listed;
    for (const std::uint32_t c : cubes)
      for (std::uint32_t t = index.cubes()[c].begin; t < index.cubes()[c].end; ++t)
        listed.insert(detail::cell_of_code(index.codes()[t]));
    for (const VoxelKey& to : targets) ASSERT_TRUE(!reach.contains(from, to) || listed.contains(to));
  }
}

TEST(RankDraw, DrawsEverySetWithEqualChance) {
  detail::RankDraw draw;
  std::map<std::vector<std::uint32_t>, int> count;
  constexpr int kDraws = 40'000;
  for (int i = 0; i < kDraws; ++i) {
    const VoxelKey voxel{key(i), key(i / 7), key(i % 11)};
    const auto& ranks = draw.draw(6, 3, detail::VoxelRandom(static_cast<std::uint64_t>(i % 5), voxel));
    ASSERT_TRUE(std::is_sorted(ranks.begin(), ranks.end()));
    ++count[ranks];
  }
  ASSERT_EQ(count.size(), 20U);
  double chi_squared = 0;
  for (const auto& [ranks, times] : count)
    chi_squared += std::pow(times - kDraws / 20.0, 2) / (kDraws / 20.0);
  EXPECT_LT(chi_squared, 43.8);  // 0.1 % of the time with 19 degrees of freedom
}

TEST(RankDraw, DrawsDifferentRanksBelowThePopulation) {
  detail::RankDraw draw;
  for (const std::uint32_t population : {0U, 1U, 63U, 64U, 65U, 1000U, 100'000U})
    for (const std::uint32_t count : {1U, 2U, 64U, 999U, 5'000U}) {
      const std::vector<std::uint32_t> ranks =
          draw.draw(population, count, detail::VoxelRandom(1, {1, 2, 3}));
      ASSERT_EQ(ranks.size(), std::min(population, count));
      ASSERT_TRUE(std::adjacent_find(ranks.begin(), ranks.end(), std::greater_equal<>()) == ranks.end());
      ASSERT_TRUE(ranks.empty() || ranks.back() < population);
      ASSERT_EQ(ranks, draw.draw(population, count, detail::VoxelRandom(1, {1, 2, 3})));
    }
}

TEST(VoxelRandom, DependsOnSeedAndEveryCoordinate) {
  const auto first = [](std::uint64_t seed, const VoxelKey& voxel) {
    return detail::VoxelRandom(seed, voxel).below(1U << 31U);
  };
  std::set<std::uint32_t> values;
  for (std::uint64_t seed : {0U, 1U, 2U})
    for (const VoxelKey& voxel : {VoxelKey{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {65535, 65535, 65535}})
      values.insert(first(seed, voxel));
  EXPECT_EQ(values.size(), 15U);
}

}  // namespace
}  // namespace frontlux::test
