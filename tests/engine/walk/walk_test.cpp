// The integer rule between voxel centres against a path made another way: all crossings as exact fractions,
// sorted.

#include "walk/walk.hpp"

#include "support/maps.hpp"
#include "support/ray_samples.hpp"

#include <frontlux/octomap.hpp>

namespace frontlux::test {
namespace {

std::vector<VoxelKey> path_by_fractions(const VoxelKey& from, const VoxelKey& to) {
  struct Crossing {
    std::int64_t numerator, denominator;  // time of the crossing
    int rank;                             // z before y before x
    std::size_t axis;
  };
  const auto a = detail::as_array(from), b = detail::as_array(to);
  std::vector<Crossing> crossings;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t distance = std::abs(b[axis] - a[axis]);
    for (std::int64_t n = 1; n <= distance; ++n)
      crossings.push_back({2 * n - 1, 2 * distance, 2 - static_cast<int>(axis), axis});
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& p, const Crossing& q) {
    const std::int64_t left = p.numerator * q.denominator, right = q.numerator * p.denominator;
    return left != right ? left < right : p.rank < q.rank;
  });
  std::vector<VoxelKey> path{from};
  auto at = a;
  for (const Crossing& crossing : crossings) {
    at[crossing.axis] += b[crossing.axis] > a[crossing.axis] ? 1 : -1;
    path.push_back(detail::as_key(at));
  }
  return path;
}

bool visible_by_fractions(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown) {
  const auto path = path_by_fractions(segment.from, segment.to);
  for (std::size_t i = 1; i + 1 < path.size(); ++i)
    if (detail::blocks(grid.at(path[i]), unknown)) return false;
  return true;
}

TEST(Walk, BetweenVoxelCentresFollowsTheExactLine) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
    for (const auto& tree : {make_random_tree(seed, 0.3), make_noise_tree(seed, 0.3, 24)}) {
      const VoxelGrid grid = make_voxel_grid(*tree);
      std::size_t visible = 0;
      for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass})
        for (const KeySegment& segment : adversarial_key_segments(grid, 20'000, seed)) {
          const bool expected = visible_by_fractions(grid, segment, unknown);
          ASSERT_EQ(detail::walk_visible(grid, segment, unknown), expected);
          visible += expected ? 1 : 0;
        }
      EXPECT_GT(visible, std::size_t{1000});
    }
}

TEST(Walk, KnowsTheVoxelBeforeTheEnd) {
  const VoxelKey from{100, 100, 100};
  for_each_key({{96, 96, 96}, {104, 104, 104}}, [&](const VoxelKey& to) {
    if (to == from) return;
    const auto path = path_by_fractions(from, to);
    EXPECT_EQ(detail::voxel_before_end(from, to), path[path.size() - 2]);
  });
}

// The longest paths there are: the scaled times must not overflow.
TEST(Walk, HoldsAcrossTheWholeKeyRange) {
  VoxelGrid grid(0.1);
  grid.fill({{}, 16}, Occupancy::kFree);
  const VoxelKey low{0, 0, 0}, high{65535, 65534, 65533};
  EXPECT_TRUE(detail::walk_visible(grid, KeySegment{low, high}, UnknownPolicy::kBlock));
  const auto path = path_by_fractions(low, high);
  grid.set(path[path.size() - 2], Occupancy::kOccupied);
  EXPECT_FALSE(detail::walk_visible(grid, KeySegment{low, high}, UnknownPolicy::kBlock));
}

TEST(Walk, EndVoxelsNeverBlock) {
  VoxelGrid grid(0.1);
  const VoxelKey a{100, 100, 100}, b{101, 100, 100}, c{102, 100, 100};
  for (const VoxelKey& key : {a, b, c}) grid.set(key, Occupancy::kOccupied);
  EXPECT_TRUE(detail::walk_visible(grid, KeySegment{a, a}, UnknownPolicy::kBlock));
  EXPECT_TRUE(detail::walk_visible(grid, KeySegment{a, b}, UnknownPolicy::kBlock));
  EXPECT_FALSE(detail::walk_visible(grid, KeySegment{a, c}, UnknownPolicy::kPass));
  grid.set(b, Occupancy::kUnknown);
  EXPECT_FALSE(detail::walk_visible(grid, KeySegment{a, c}, UnknownPolicy::kBlock));
  EXPECT_TRUE(detail::walk_visible(grid, KeySegment{a, c}, UnknownPolicy::kPass));
}

}  // namespace
}  // namespace frontlux::test
