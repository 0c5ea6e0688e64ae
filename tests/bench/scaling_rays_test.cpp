#include "maps/filled_maps.hpp"
#include "scaling/rays.hpp"
#include "support/complaint.hpp"

namespace frontlux::bench {
namespace {

std::vector<std::pair<VoxelKey, VoxelKey>> pairs_of(const std::vector<KeySegment>& segments) {
  std::vector<std::pair<VoxelKey, VoxelKey>> pairs;
  for (const KeySegment& s : segments) pairs.emplace_back(s.from, s.to);
  return pairs;
}

TEST(SegmentsOfLength, JoinFreeVoxelsAtTheLength) {
  const VoxelGrid grid = make_blocks(0.01);
  for (const double length : {2.0, 5.0, 20.0, 60.0}) {
    const auto segments = segments_of_length(grid, length, 1000);
    EXPECT_GT(segments.size(), 900U) << length;
    EXPECT_LE(segments.size(), 1000U) << length;
    double steepest = 0;
    for (const KeySegment& s : segments) {
      ASSERT_EQ(grid.at(s.from), Occupancy::kFree);
      ASSERT_EQ(grid.at(s.to), Occupancy::kFree);
      const double x = s.to.x - s.from.x, y = s.to.y - s.from.y, z = s.to.z - s.from.z;
      ASSERT_NEAR(std::sqrt(x * x + y * y + z * z) * kBlocksResolution, length, kBlocksResolution);
      steepest = std::max(steepest, std::abs(z) / std::hypot(x, y));
    }
    EXPECT_LT(steepest, std::tan(20 * 3.14159265 / 180) + kBlocksResolution / length);
    EXPECT_EQ(pairs_of(segments), pairs_of(segments_of_length(grid, length, 1000)));
  }
}

TEST(SegmentsOfLength, GoViewpointByViewpointAndNoneTwice) {
  const auto pairs = pairs_of(segments_of_length(make_rooms({2, 2, 1}), 5.0, 6400));
  std::vector<VoxelKey> viewpoints;
  for (const auto& [from, to] : pairs)
    if (viewpoints.empty() || viewpoints.back() != from) viewpoints.push_back(from);
  EXPECT_GT(viewpoints.size(), 90U);
  std::sort(viewpoints.begin(), viewpoints.end());
  EXPECT_EQ(std::adjacent_find(viewpoints.begin(), viewpoints.end()), viewpoints.end());
  auto sorted = pairs;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
}

TEST(SegmentsOfLength, GoInAllDirections) {
  const auto segments = segments_of_length(make_blocks(0.0), 5.0, 6400);
  int quadrants[4] = {}, up = 0;
  for (const KeySegment& s : segments) {
    ++quadrants[(s.to.x > s.from.x ? 1 : 0) + (s.to.y > s.from.y ? 2 : 0)];
    up += s.to.z > s.from.z ? 1 : 0;
  }
  for (const int quadrant : quadrants) EXPECT_NEAR(quadrant, 1600, 400);
  EXPECT_NEAR(up, 3200, 600);
}

TEST(SegmentsOfLength, FewerWhereTheMapIsTooSmall) {
  EXPECT_TRUE(segments_of_length(make_rooms({1, 1, 1}), 20.0, 500).empty());
  EXPECT_TRUE(segments_of_length(VoxelGrid(0.1), 5.0, 500).empty());
  const VoxelGrid grid = make_blocks(0.0);
  EXPECT_TRUE(segments_of_length(grid, 1e30, 500).empty());
  for (const double length :
       {0.0, -3.0, 0.3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_REFUSED(segments_of_length(grid, length, 10));
}

TEST(RaysAlong, StartInTheFirstVoxelTowardsTheSecond) {
  const VoxelGrid grid = make_rooms({2, 1, 1});
  const Lattice& lattice = grid.lattice();
  const auto segments = segments_of_length(grid, 3.0, 500);
  const auto rays = rays_along(segments, lattice, 3.0);
  ASSERT_EQ(rays.size(), segments.size());
  ASSERT_GT(rays.size(), 400U);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(lattice.key(rays[i].origin), segments[i].from);
    EXPECT_EQ(lattice.key(lattice.center(segments[i].from) + rays[i].direction), segments[i].to);
    EXPECT_EQ(rays[i].max_range, 3.0);
  }
}

TEST(Shuffled, IsTheSameQueriesInAnotherOrder) {
  const VoxelGrid grid = make_rooms({2, 2, 1});
  Workload workload{"both", segments_of_length(grid, 5.0, 3000), {}, {}};
  workload.batches.push_back({rays_along(workload.segments, grid.lattice(), 5.0), UnknownPolicy::kPass});
  const Workload mixed = shuffled(workload);
  auto before = pairs_of(workload.segments), after = pairs_of(mixed.segments);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < before.size(); ++i) kept += before[i] == after[i] ? 1 : 0;
  EXPECT_LT(kept, before.size() / 100);
  EXPECT_EQ(after, pairs_of(shuffled(workload).segments));
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_EQ(before, after);

  const auto bits_of = [](const Workload& w) {
    std::vector<std::array<float, 6>> bits;
    for (const Ray& r : w.batches.at(0).rays)
      bits.push_back(
          {r.origin.x(), r.origin.y(), r.origin.z(), r.direction.x(), r.direction.y(), r.direction.z()});
    return bits;
  };
  auto rays_before = bits_of(workload), rays_after = bits_of(mixed);
  EXPECT_NE(rays_before, rays_after);
  std::sort(rays_before.begin(), rays_before.end());
  std::sort(rays_after.begin(), rays_after.end());
  EXPECT_EQ(rays_before, rays_after);
}

}  // namespace
}  // namespace frontlux::bench
