// The sliding window against summing up each window anew; the bins.

#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/views.hpp"
#include "view/azimuth_bins.hpp"

#include <frontlux/view_quality.hpp>

namespace frontlux::test {
namespace {

struct Expected {
  std::size_t begin = 0;
  std::uint64_t hits = 0;
};

Expected sum_up(const std::vector<std::uint32_t>& bins, std::size_t window, std::optional<std::size_t> with) {
  std::optional<Expected> best;
  for (std::size_t begin = 0; begin < bins.size(); ++begin) {
    std::uint64_t hits = 0;
    bool holds = !with;
    for (std::size_t b = begin; b < begin + window; ++b) {
      hits += bins[b % bins.size()];
      holds = holds || b % bins.size() == *with;
    }
    if (holds && (!best || hits > best->hits)) best = {begin, hits};
  }
  return *best;
}

TEST(BestWindow, EqualsTheBestOfAllWindows) {
  Random random(1);
  for (int i = 0; i < 3'000; ++i) {
    const auto count = static_cast<std::size_t>(1 + random.below(40));
    const auto window = static_cast<std::size_t>(1 + random.below(static_cast<int>(count)));
    std::vector<std::uint32_t> bins(count);
    for (auto& bin : bins)
      bin = static_cast<std::uint32_t>(random.one_in(50) ? 4'000'000'000 : random.below(4));
    const double width = 2 * std::numbers::pi / static_cast<double>(count);
    // From just the bins' own width to just short of one bin more.
    const double opening = width * (static_cast<double>(window) + (random.one_in(2) ? 0.0 : 0.99));
    std::optional<std::size_t> with;
    if (random.one_in(2)) with = static_cast<std::size_t>(random.below(static_cast<int>(count)));
    std::optional<double> azimuth;
    if (with)
      azimuth = (static_cast<double>(*with) + 0.5) * width + 2 * std::numbers::pi * (random.below(5) - 2);
    const Expected expected = sum_up(bins, window, with);
    const AzimuthWindow found = best_window(bins, opening, azimuth);
    ASSERT_EQ(found.hits, expected.hits);
    const double middle = (static_cast<double>(expected.begin) + static_cast<double>(window) / 2) * width;
    ASSERT_NEAR(std::remainder(found.yaw - middle, 2 * std::numbers::pi), 0.0, 1e-9);
    ASSERT_LE(std::fabs(found.yaw), std::numbers::pi + 1e-12);
    if (with) {
      ASSERT_LE(std::fabs(std::remainder(*azimuth - found.yaw, 2 * std::numbers::pi)), opening / 2 + 1e-9);
    }
  }
}

TEST(BestWindow, ACameraOf90DegreesHoldsNineBinsOf36) {
  std::vector<std::uint32_t> bins(36, 1);
  EXPECT_EQ(best_window(bins, 90 * kDegree).hits, 9U);
  EXPECT_EQ(best_window(bins, 89.9 * kDegree).hits, 8U);
  EXPECT_EQ(best_window(bins, 400 * kDegree).hits, 36U);
  bins[35] = bins[0] = 5;  // around azimuth 0
  EXPECT_EQ(best_window(bins, 20 * kDegree).hits, 10U);
  EXPECT_NEAR(best_window(bins, 20 * kDegree).yaw, 0.0, 1e-12);
}

TEST(BestWindow, RefusesWhatHasNoAnswer) {
  const std::vector<std::uint32_t> bins(36, 1);
  EXPECT_REFUSED(best_window({}, 1.0));
  EXPECT_REFUSED(best_window(std::vector<std::uint32_t>(3601), 1.0));
  for (const double opening : {9.9 * kDegree, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_REFUSED(best_window(bins, opening));
  EXPECT_REFUSED(best_window(bins, 1.0, std::nan("")));
}

TEST(AzimuthBins, CountFromAzimuthZeroUpwards) {
  const std::pair<double, int> expected[] = {
      {0.0, 0},      {9.999 * kDegree, 0},   {10.001 * kDegree, 1},   {-0.001 * kDegree, 35},
      {-1e-300, 35}, {std::numbers::pi, 18}, {-std::numbers::pi, 18}, {745 * kDegree, 2}};
  for (const auto& [azimuth, bin] : expected) EXPECT_EQ(detail::azimuth_bin(azimuth, 36), bin) << azimuth;
  EXPECT_EQ(detail::azimuth_bin(1.0, 1), 0);
  const ViewRegion region({FieldOfView::Shape::kSpinning, 0.0, 1.0, 9.5}, 1.0);
  const detail::AzimuthBins bins(region, 36);
  for (int dx = -9; dx <= 9; ++dx)
    for (int dy = -9; dy <= 9; ++dy)
      ASSERT_EQ(bins[region.entry(dx, dy)], detail::azimuth_bin(std::atan2(dy, dx), 36));
}

// Every voxel of a box is in one of the box's sectors, and a box to one side leaves others out.
TEST(AzimuthBins, OfABoxAreThoseOfItsVoxels) {
  const ViewRegion region({FieldOfView::Shape::kSpinning, 0, 1, 2.0}, 0.25);
  Random random(11);
  std::size_t in_part = 0;
  for (const int count : {1, 2, 7, 36, 64, 65, 100, 3600}) {
    const detail::AzimuthBins bins(region, count);
    for (int i = 0; i < 2000; ++i) {
      const VoxelKey from{32768, 32768, 32768};
      const VoxelKey corner =
          *offset_key(from, random.below(61) - 30, random.below(61) - 30, random.below(9) - 4);
      const KeyBox box{corner, *offset_key(corner, random.below(10), random.below(10), random.below(10))};
      const detail::SectorSet sectors = bins.sectors_of(from, box);
      in_part += sectors == detail::SectorSet::all() ? 0 : 1;
      for (int x = box.min.x; x <= box.max.x; ++x)
        for (int y = box.min.y; y <= box.max.y; ++y) {
          const int bin = detail::azimuth_bin(std::atan2(y - from.y, x - from.x), count);
          ASSERT_TRUE(sectors.contains(detail::SectorSet::of(bin, count)))
              << count << " bins, " << x - from.x << ' ' << y - from.y;
        }
    }
  }
  EXPECT_GT(in_part, 8000U);
}

TEST(SectorSet, GoesOnFromTheLastToTheFirst) {
  using detail::SectorSet;
  const SectorSet few = SectorSet::between(34, 1, 36);
  for (int bin = 0; bin < 36; ++bin)
    EXPECT_EQ(few.contains(SectorSet::of(bin, 36)), bin >= 34 || bin <= 1) << bin;
  std::vector<std::uint32_t> numbers(36, 5);
  few.clear(numbers);
  EXPECT_EQ(std::ranges::count(numbers, 0U), 4);
  EXPECT_FALSE(SectorSet().any());
  // More than 64 are taken together: 0 and 1 of 128.
  EXPECT_TRUE(SectorSet::of(0, 128).contains(SectorSet::of(1, 128)));
  EXPECT_FALSE(SectorSet::of(0, 128).contains(SectorSet::of(2, 128)));
}

}  // namespace
}  // namespace frontlux::test
