// Which clusters are one stop when tours are searched.

#include "tour/stop_groups.hpp"

#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

constexpr int kZone = 10;

// Of one robot, unless it is said who sees it.
SeenCluster cluster(std::uint32_t place, const VoxelKey& middle, double distance,
                    std::vector<bool> by = {true}) {
  return {place, middle, std::move(by), distance, false};
}

TEST(StopGroups, WhatIsNearIsAloneAndWhatIsFarGoesByZoneAndByWhoSeesIt) {
  const std::vector<SeenCluster> seen = {
      cluster(0, make_key(1, 1, 1), 0.5),
      cluster(1, make_key(2, 1, 1), 1.0),  // near
      cluster(2, make_key(31, 1, 1), 2.0, {true, false}),
      cluster(3, make_key(39, 9, 9), 2.1, {true, false}),
      cluster(4, make_key(39, 9, 9), 2.1, {true, true}),    // the same zone, but others can look at it
      cluster(5, make_key(40, 9, 9), 2.1, {true, false})};  // the next zone
  std::vector<StopClusters> stops = group_into_stops(seen, kZone);
  std::ranges::sort(stops);
  EXPECT_EQ(stops, (std::vector<StopClusters>{{0}, {1}, {2, 3}, {4}, {5}}));
}

TEST(StopGroups, FarAwayZonesAreAsMuchWider) {
  // Beyond four times the distance zones have twice the edge, beyond eight times four times.
  const auto far = [](double distance) {
    std::vector<SeenCluster> seen;
    for (int i = 0; i < 16; ++i)
      seen.push_back(cluster(static_cast<std::uint32_t>(i), make_key(400 + 10 * i, 5, 5), distance));
    return group_into_stops(seen, kZone).size();
  };
  EXPECT_EQ(far(3.9), 16U);
  EXPECT_EQ(far(4.1), 8U);
  EXPECT_EQ(far(8.1), 4U);
}

// Clusters all over a square around the robot, in the middle of it.
std::vector<SeenCluster> scattered(std::size_t count, double near, int half) {
  test::Random random(7);
  std::vector<SeenCluster> seen;
  for (std::uint32_t i = 0; i < count; ++i) {
    const int x = random.below(2 * half), y = random.below(2 * half);
    seen.push_back(cluster(i, make_key(30000 + x, 30000 + y, 0), std::hypot(x - half, y - half) / near));
  }
  return seen;
}

TEST(StopGroups, HoldEveryClusterOnceHoweverManyThereAre) {
  for (const std::size_t count : {0, 1, 150, 1000, 4000})
    for (const double near : {20.0, 200.0, 3000.0}) {
      std::vector<std::uint32_t> held;
      for (const StopClusters& stop : group_into_stops(scattered(count, near, 1000), kZone))
        held.insert(held.end(), stop.begin(), stop.end());
      std::ranges::sort(held);
      std::vector<std::uint32_t> all(count);
      std::iota(all.begin(), all.end(), 0U);
      EXPECT_EQ(held, all) << count << " clusters, near up to " << near;
    }
}

TEST(StopGroups, VeryManyNearClustersAreNotAllAlone) {
  const std::vector<SeenCluster> all_near = scattered(4000, 3000.0, 1000);
  ASSERT_TRUE(std::ranges::all_of(all_near, [](const SeenCluster& c) { return c.distance <= 1.0; }));
  EXPECT_LE(group_into_stops(all_near, 200).size(), 500U);
  EXPECT_EQ(group_into_stops(std::span(all_near).first(500), 200).size(), 500U);
}

TEST(StopGroups, WhereARobotGoesIsAloneHoweverManyAreNear) {
  std::vector<SeenCluster> seen = scattered(4000, 3000.0, 1000);
  for (std::size_t i = 0; i < seen.size(); i += 500) seen[i].is_next = true;
  const std::vector<StopClusters> stops = group_into_stops(seen, 100);
  for (std::size_t i = 0; i < seen.size(); i += 500)
    EXPECT_EQ(std::ranges::count(stops, StopClusters{seen[i].cluster}), 1);
}

}  // namespace
}  // namespace frontlux::planner::detail
