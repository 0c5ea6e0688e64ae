#include "tour/joined_stops.hpp"

#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

SharedViews random_views(Random& random, std::size_t clusters) {
  SharedViews views;
  for (std::size_t c = 0; c < clusters; ++c) {
    views.sizes.push_back(10 + random.below(90));
    for (int v = random.below(4); v > 0; --v) views.found_for.push_back(c);
  }
  views.parts = NumberTable(views.found_for.size(), clusters);
  for (std::size_t v = 0; v < views.found_for.size(); ++v)
    for (std::size_t c = 0; c < clusters; ++c)
      if (views.found_for[v] == c || random.one_in(3)) views.parts(v, c) = random.below(5) / 4.0;
  return views;
}

// At least 0.7 of what any viewpoint has in view, and something.
bool sees(const SharedViews& views, std::size_t viewpoint, std::size_t cluster) {
  if (views.found_for[viewpoint] == cluster) return true;
  double most = 0.0;
  for (std::size_t v = 0; v < views.found_for.size(); ++v) most = std::max(most, views.parts(v, cluster));
  return views.parts(viewpoint, cluster) > 0.0 && views.parts(viewpoint, cluster) >= 0.7 * most;
}

double frontiers(const SharedViews& views, std::size_t viewpoint, const std::vector<std::size_t>& clusters) {
  double sum = 0.0;
  for (const std::size_t c : clusters)
    if (sees(views, viewpoint, c)) sum += std::max(1.0, views.parts(viewpoint, c) * views.sizes[c]);
  return sum;
}

double frontiers(const SharedViews& views, const JoinedStop& stop) {
  return frontiers(views, stop.viewpoints.front(), stop.clusters);
}

TEST(JoinedStops, HoldEachClusterThatIsSeenOnce) {
  Random random(71);
  for (int round = 0; round < 200; ++round) {
    const SharedViews views = random_views(random, static_cast<std::size_t>(1 + random.below(12)));
    std::vector<int> count(views.sizes.size());
    std::size_t before = 0;
    for (const JoinedStop& stop : join_clusters(views)) {
      ASSERT_FALSE(stop.clusters.empty());
      EXPECT_TRUE(std::ranges::is_sorted(stop.clusters));
      EXPECT_GE(stop.clusters.front(), before);  // in order of their first clusters
      before = stop.clusters.front();
      for (const std::size_t c : stop.clusters) ++count[c];
      for (std::size_t v = 0; v < views.found_for.size(); ++v)
        EXPECT_EQ(std::ranges::find(stop.viewpoints, v) != stop.viewpoints.end(),
                  std::ranges::all_of(stop.clusters, [&](std::size_t c) { return sees(views, v, c); }));
      for (const std::size_t v : stop.viewpoints)
        EXPECT_LE(frontiers(views, v, stop.clusters), frontiers(views, stop) + 1e-9);
    }
    for (std::size_t c = 0; c < count.size(); ++c) {
      bool seen = false;
      for (std::size_t v = 0; v < views.found_for.size(); ++v) seen = seen || sees(views, v, c);
      EXPECT_EQ(count[c], seen ? 1 : 0);
    }
  }
}

// The stops, from the one with most frontiers on: each time no viewpoint has more of the clusters left in
// view.
TEST(JoinedStops, TakeTheBestViewpointOfWhatIsLeft) {
  Random random(72);
  for (int round = 0; round < 200; ++round) {
    const SharedViews views = random_views(random, 10);
    std::vector<JoinedStop> stops = join_clusters(views);
    std::ranges::stable_sort(stops, std::greater(),
                             [&](const JoinedStop& stop) { return frontiers(views, stop); });
    std::vector<std::size_t> left(views.sizes.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    for (const JoinedStop& stop : stops) {
      for (std::size_t v = 0; v < views.found_for.size(); ++v)
        EXPECT_LE(frontiers(views, v, left), frontiers(views, stop) + 1e-9);
      std::erase_if(
          left, [&](std::size_t c) { return std::ranges::find(stop.clusters, c) != stop.clusters.end(); });
    }
  }
}

TEST(JoinedStops, AreOneWhereOneViewpointSeesAll) {
  SharedViews views{{0, 1, 2}, NumberTable(3, 3), {20, 30, 40}};
  for (std::size_t c = 0; c < 3; ++c) views.parts(1, c) = 0.9;
  views.parts(0, 0) = views.parts(2, 2) = 1.0;
  const auto stops = join_clusters(views);
  ASSERT_EQ(stops.size(), 1u);
  EXPECT_EQ(stops[0].clusters, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(stops[0].viewpoints, (std::vector<std::size_t>{1}));
}

TEST(JoinedStops, AreOfOneClusterEachIfNotJoined) {
  Random random(73);
  for (int round = 0; round < 50; ++round) {
    const SharedViews views = random_views(random, static_cast<std::size_t>(1 + random.below(12)));
    std::vector<std::size_t> viewpoints;
    for (const JoinedStop& stop : single_stops(views)) {
      ASSERT_EQ(stop.clusters.size(), 1U);
      for (const std::size_t v : stop.viewpoints) EXPECT_EQ(views.found_for[v], stop.clusters[0]);
      viewpoints.insert(viewpoints.end(), stop.viewpoints.begin(), stop.viewpoints.end());
    }
    std::vector<std::size_t> all(views.found_for.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    EXPECT_EQ(viewpoints, all) << "each once, in order";
  }
}

TEST(JoinedStops, AreNoneOfNothing) {
  EXPECT_TRUE(join_clusters({}).empty());
  EXPECT_TRUE(single_stops({}).empty());
}

}  // namespace
}  // namespace frontlux::planner::detail
