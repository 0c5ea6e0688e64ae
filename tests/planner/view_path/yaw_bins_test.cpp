// Choices among yaw bins against every choice there is.

#include "view_path/yaw_bins.hpp"

#include "support/random.hpp"
#include "support/random_view.hpp"

#include <frontlux/planner/path_optimizer.hpp>

namespace frontlux::planner {
namespace {

using test::Scene;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::uint64_t views_of(const Scene& scene, const std::vector<double>& yaws) {
  std::uint64_t views = 0;
  for (const auto& [i, j] : scene.list)
    views += scene.view.contains(scene.frontiers[j] - scene.path[i].position, yaws[i]) ? 1U : 0U;
  return views;
}

// The best of all choices within the limits.
struct Best {
  std::uint64_t views = 0, distinct = 0;
  std::size_t choices = 0;

  Best(const Scene& scene, std::size_t bins, const YawLimits& limits) {
    choose(scene, bins, limits, scene.yaws(), 1);
  }

 private:
  void choose(const Scene& scene, std::size_t bins, const YawLimits& limits, std::vector<double> yaws,
              std::size_t i) {
    if (i + 1 < yaws.size()) {
      std::vector<double> some;
      for (std::size_t b = 0; b < bins; ++b)
        some.push_back(2.0 * std::numbers::pi * static_cast<double>(b) / static_cast<double>(bins));
      if (limits.limited()) some.push_back(limits.even_turn(yaws.front(), yaws.back())[i]);
      for (const double yaw : some) {
        yaws[i] = yaw;
        choose(scene, bins, limits, yaws, i + 1);
      }
    } else if (limits.allows(yaws)) {
      ++choices;
      views = std::max(views, views_of(scene, yaws));
      distinct = std::max(distinct, test::distinct_by_hand(scene, yaws));
    }
  }
};

TEST(YawBins, MostViewsIsTheBestOfAllChoicesAndMostDistinctIsNear) {
  test::Random random(3);
  std::uint64_t distinct = 0, most_distinct = 0;
  int limited_trials = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Scene scene = test::random_scene(random, 1 + random.below(5), 60, 0.5);
    const std::size_t bins = 1 + static_cast<std::size_t>(random.below(7));
    const YawLimits limits(scene.path, trial % 2 == 0 ? kInfinity : random.uniform(0.25, 1.6));
    const Best best(scene, bins, limits);
    if (best.choices == 0) continue;  // not even the even turn keeps the limits
    limited_trials += limits.limited() ? 1 : 0;
    const InformationGain gain = scene.gain();
    const double first = scene.path.front().yaw, last = scene.path.back().yaw;
    const YawBins yaw_bins(gain, static_cast<int>(bins), tangent_yaws(scene.path), limits);
    const auto views = yaw_bins.most_views(), seen = yaw_bins.most_distinct();
    for (const auto& yaws : {views, seen}) {
      ASSERT_EQ(yaws.size(), scene.path.size());
      EXPECT_EQ(yaws.front(), first);
      EXPECT_EQ(yaws.back(), yaws.size() == 1 ? first : last);
      EXPECT_TRUE(limits.allows(yaws));
    }
    EXPECT_EQ(views_of(scene, views), best.views);
    const std::uint64_t reached = test::distinct_by_hand(scene, seen);
    EXPECT_LE(reached, best.distinct);
    // What is known of greedy choices without limits: at least half; with the sweeps it comes much nearer.
    if (!limits.limited()) {
      EXPECT_GE(static_cast<double>(reached), 0.85 * static_cast<double>(best.distinct));
    }
    distinct += reached;
    most_distinct += best.distinct;
  }
  EXPECT_GT(limited_trials, 15);
  EXPECT_GE(static_cast<double>(distinct), 0.97 * static_cast<double>(most_distinct));
}

TEST(YawBins, OfYawsThatSeeAsManyTheNearestToThePathIsChosen) {
  Scene scene{std::vector<Pose>(9), {}, {}, test::camera()};
  for (std::size_t i = 0; i < scene.path.size(); ++i)
    scene.path[i].position = {0.0, 0.4 * static_cast<double>(i), 0.0};
  scene.path.front().yaw = 1.0, scene.path.back().yaw = 2.0;
  const double along = std::numbers::pi / 2;
  for (const double rate : {kInfinity, 1.5})
    for (const bool seen : {false, true}) {
      scene.frontiers.clear(), scene.list.clear();
      if (seen) {  // by the fifth alone, beside the path
        scene.frontiers = {scene.path[4].position + Eigen::Vector3d(3.0, 0.0, 0.0)};
        scene.list = {{4, 0}};
      }
      const InformationGain gain = scene.gain();
      const YawLimits limits(scene.path, rate);
      const YawBins bins(gain, 24, tangent_yaws(scene.path), limits);
      for (const auto& yaws : {bins.most_views(), bins.most_distinct()}) {
        EXPECT_EQ(test::distinct_by_hand(scene, yaws), seen ? 1U : 0U);
        EXPECT_NEAR(yaws[2], along, 1e-9);
        EXPECT_NEAR(yaws[6], along, 1e-9);
        if (!seen) {
          EXPECT_NEAR(yaws[4], along, 1e-9);
        }
      }
    }
}

}  // namespace
}  // namespace frontlux::planner
