#include "view/rank_draw.hpp"

#include "support/test.hpp"

#include <frontlux/key_box.hpp>

namespace frontlux::test {
namespace {

TEST(RankDraw, DrawsEverySetWithEqualChance) {
  detail::RankDraw draw;
  std::map<std::vector<std::uint32_t>, int> count;
  constexpr int kDraws = 40'000;
  for (int i = 0; i < kDraws; ++i) {
    const VoxelKey voxel = make_key(i, i / 7, i % 11);
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
