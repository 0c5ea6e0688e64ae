#include "support/complaint.hpp"
#include "support/folder_test.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"
#include "support/random_view.hpp"

#include <frontlux/planner/path_optimizer.hpp>

#include <thread>

namespace frontlux::planner {
namespace {

using test::Random;
using test::Scene;

constexpr double kPi = std::numbers::pi;

OptimizedPath optimize(const Scene& scene, const PathOptimizerOptions& options = {}) {
  return optimize_path(scene.path, scene.frontiers, scene.pairs(), scene.view, options);
}

double angle_between(double a, double b) { return std::fabs(std::remainder(b - a, 2.0 * kPi)); }

std::vector<PathOptimizerOptions> all_modes() {
  std::vector<PathOptimizerOptions> all;
  for (const YawStart start : {YawStart::kGreedy, YawStart::kBestBins, YawStart::kTangent})
    for (const GainMode mode : {GainMode::kOr, GainMode::kSum})
      for (const bool ascend : {true, false}) {
        PathOptimizerOptions& options = all.emplace_back();
        options.start = start;
        options.gain.mode = mode;
        options.ascend = ascend;
      }
  return all;
}

TEST(PathOptimizer, NeverSeesFewerThanItsStartOrTheTangent) {
  Random random(1);
  std::uint64_t tangent = 0, greedy = 0, ascended = 0;
  for (int trial = 0; trial < (test::long_mode() ? 25 : 10); ++trial) {
    const Scene scene = test::random_scene(random, 3 + random.below(10), 20 + random.below(400), 0.5);
    const std::uint64_t by_tangent = test::distinct_by_hand(scene, tangent_yaws(scene.path));
    for (const PathOptimizerOptions& options : all_modes()) {
      const OptimizedPath path = optimize(scene, options);
      ASSERT_EQ(path.yaws.size(), scene.path.size());
      EXPECT_EQ(path.yaws.front(), scene.path.front().yaw);
      EXPECT_EQ(path.yaws.back(), scene.path.back().yaw);
      for (std::size_t i = 1; i + 1 < path.yaws.size(); ++i) EXPECT_LE(std::fabs(path.yaws[i]), kPi);
      EXPECT_EQ(path.result.distinct, test::distinct_by_hand(scene, path.yaws));
      EXPECT_EQ(path.tangent.distinct, by_tangent);
      EXPECT_NEAR(path.result.fuzzy, scene.gain(options.gain).value(path.yaws, options.sharpness.back()),
                  1e-9 * (1.0 + path.result.fuzzy));
      EXPECT_GE(path.result.distinct, path.start.distinct);
      EXPECT_GE(path.result.distinct, path.tangent.distinct);
      EXPECT_LE(path.evaluations, options.max_evaluations);
    }
    const OptimizedPath best = optimize(scene);
    tangent += best.tangent.distinct;
    greedy += best.start.distinct;
    ascended += best.result.distinct;
  }
  EXPECT_GT(2 * greedy, 3 * tangent);  // half as much again
  EXPECT_GT(ascended, greedy);
}

TEST(PathOptimizer, TheGradientTurnsAViewpointTowardsWhatItMisses) {
  Scene scene{{{{0, 0, 0}, 0.0}, {{1.2, 0, 0}, 0.0}, {{2.4, 0, 0}, 0.0}}, {}, {}, test::camera()};
  for (std::uint32_t j = 0; j < 20; ++j) {
    const double azimuth = 1.0 + 0.02 * j;  // all of them just outside of the view along the path
    scene.frontiers.push_back(scene.path[1].position +
                              5.0 * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0));
    scene.list.push_back({1, j});
  }
  PathOptimizerOptions options = paper_optimizer_options();
  const OptimizedPath path = optimize(scene, options);
  EXPECT_EQ(path.tangent.distinct, 0U);
  EXPECT_EQ(path.result.distinct, 20U);
  // The best is in the middle of them, by symmetry.
  options.max_evaluations = 400;
  options.sharpness = {8.0};
  const OptimizedPath settled = optimize(scene, options);
  EXPECT_EQ(settled.end, OptimizationEnd::kConverged) << describe(settled.end);
  EXPECT_NEAR(settled.yaws[1], 1.19, 1e-2);
}

TEST(PathOptimizer, KeepsTheLimitsOnTurning) {
  Random random(4);
  int unreachable = 0, turned = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Scene scene = test::random_scene(random, 3 + random.below(8), 150, 0.5);
    if (trial % 4 == 0) scene.path.back().yaw = random.uniform(-9.0, 9.0);
    if (trial % 5 == 0) scene.path[1].position = scene.path[0].position;  // no length, no turn by rate
    PathOptimizerOptions options;
    options.start = trial % 3 == 0 ? YawStart::kTangent : YawStart::kGreedy;
    options.max_yaw_rate = random.uniform(0.1, 1.5);
    const OptimizedPath path = optimize(scene, options);
    double all = 0.0;
    for (std::size_t i = 0; i + 1 < path.yaws.size(); ++i) {
      const double length = (scene.path[i + 1].position - scene.path[i].position).norm();
      const double limit = options.max_yaw_rate * length;
      all += limit;
      if (path.end != OptimizationEnd::kLimitsUnreachable) {
        EXPECT_LE(angle_between(path.yaws[i], path.yaws[i + 1]), limit + 2e-9) << trial;
      }
    }
    const double needed = angle_between(path.yaws.front(), path.yaws.back());
    EXPECT_EQ(path.end == OptimizationEnd::kLimitsUnreachable, needed > all + 1e-8) << trial;
    unreachable += path.end == OptimizationEnd::kLimitsUnreachable ? 1 : 0;
    turned += path.end != OptimizationEnd::kLimitsUnreachable && path.result.distinct > path.tangent.distinct
                  ? 1
                  : 0;
    EXPECT_GE(path.result.distinct, path.start.distinct);
    EXPECT_EQ(path.result.distinct, test::distinct_by_hand(scene, path.yaws));
  }
  EXPECT_GT(unreachable, 0);
  EXPECT_GT(turned, 20);
}

TEST(PathOptimizer, WhatCannotBeTurnedHasAReason) {
  Random random(5);
  const Scene scene = test::random_scene(random, 5, 50);
  EXPECT_EQ(optimize({{}, {}, {}, test::camera()}).end, OptimizationEnd::kNothingToTurn);
  EXPECT_TRUE(optimize({{}, {}, {}, test::camera()}).yaws.empty());

  const Scene one{{scene.path[0]}, {Eigen::Vector3d(2, 0, 0)}, {{0, 0}}, test::camera()};
  EXPECT_EQ(optimize(one).end, OptimizationEnd::kNothingToTurn);
  EXPECT_EQ(optimize(one).yaws, std::vector{scene.path[0].yaw});
  EXPECT_EQ(optimize(one).result.distinct, test::distinct_by_hand(one, one.yaws()));

  const Scene two{{scene.path[0], scene.path[1]}, scene.frontiers, {{0, 0}, {1, 1}}, test::camera()};
  EXPECT_EQ(optimize(two).end, OptimizationEnd::kNothingToTurn);
  EXPECT_EQ(optimize(two).yaws, two.yaws());

  const Scene empty{scene.path, {}, {}, test::camera()};
  EXPECT_EQ(optimize(empty).end, OptimizationEnd::kNothingVisible);
  EXPECT_EQ(optimize(empty).yaws, tangent_yaws(scene.path));
  EXPECT_EQ(optimize(empty).result.distinct, 0U);

  Scene lidar = scene;
  lidar.view = {FieldOfView::Shape::kSpinning, 0.0, 0.7, 6.0};
  EXPECT_EQ(optimize(lidar).end, OptimizationEnd::kYawHasNoEffect);
  EXPECT_EQ(optimize(lidar).result.distinct, test::distinct_by_hand(lidar, lidar.yaws()));

  PathOptimizerOptions plain, short_of;
  plain.ascend = false;
  short_of.max_evaluations = 4;
  EXPECT_EQ(optimize(scene, plain).end, OptimizationEnd::kAscentOff);
  EXPECT_EQ(optimize(scene, short_of).end, OptimizationEnd::kEvaluationLimit);
  EXPECT_LE(optimize(scene, short_of).evaluations, 4);
}

TEST(PathOptimizer, TurnsOnThePathThatGoesNowhere) {
  Random random(6);
  Scene scene = test::random_scene(random, 6, 200);
  for (Pose& pose : scene.path) pose = {{1.0, 2.0, 3.0}, 0.5};
  EXPECT_EQ(tangent_yaws(scene.path), std::vector<double>(6, 0.5));
  const OptimizedPath path = optimize(scene);
  EXPECT_GT(path.result.distinct, path.tangent.distinct);
  EXPECT_EQ(path.result.distinct, test::distinct_by_hand(scene, path.yaws));
}

TEST(PathOptimizer, TangentLooksAhead) {
  const std::vector<Pose> path{{{0, 0, 0}, 9.0}, {{1, 1, 0}, 0.0}, {{1, 1, 5}, 0.0},
                               {{1, 3, 5}, 0.0}, {{0, 3, 5}, 0.0}, {{0, 2, 4}, -1.0}};
  const auto yaws = tangent_yaws(path);
  ASSERT_EQ(yaws.size(), 6U);
  EXPECT_EQ(yaws[0], 9.0);
  EXPECT_NEAR(yaws[1], 9.0 - 2.0 * kPi, 1e-12);  // straight up: as before
  EXPECT_NEAR(yaws[2], kPi / 2, 1e-12);
  EXPECT_NEAR(yaws[3], kPi, 1e-12);
  EXPECT_NEAR(yaws[4], -kPi / 2, 1e-12);
  EXPECT_EQ(yaws[5], -1.0);
}

TEST(PathOptimizer, RefusesBadInput) {
  Random random(7);
  const Scene scene = test::random_scene(random, 4, 20);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, std::numeric_limits<double>::infinity()}) {
    const auto refused = [&](const auto& spoil) {
      Scene broken = scene;
      spoil(broken);
      EXPECT_REFUSED(optimize(broken));
    };
    refused([&](Scene& s) { s.path[2].yaw = bad; });
    refused([&](Scene& s) { s.path[0].position.x() = bad; });
    refused([&](Scene& s) { s.frontiers[0].x() = bad; });
  }
  const auto refused = [&](const auto& change) {
    PathOptimizerOptions options;
    change(options);
    EXPECT_REFUSED(optimize(scene, options));
  };
  refused([&](auto& o) { o.max_yaw_rate = nan; });
  refused([&](auto& o) { o.max_yaw_rate = -1.0; });
  refused([&](auto& o) { o.yaw_bins = 0; });
  refused([&](auto& o) { o.yaw_bins = 64; });
  refused([&](auto& o) { o.sharpness = {}; });
  refused([&](auto& o) { o.sharpness = {8.0, nan}; });
  refused([&](auto& o) { o.max_evaluations = 3; });
  refused([&](auto& o) { o.gain.detection = nan; });
}

TEST(PathOptimizer, SameInputSameBytesInAnyThread) {
  Random random(8);
  const Scene scene = test::random_scene(random, 10, 500, 0.6);
  const auto expected = optimize(scene);
  std::vector<std::optional<OptimizedPath>> results(8);
  std::vector<std::thread> threads;
  for (auto& result : results) threads.emplace_back([&] { result = optimize(scene); });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) {
    EXPECT_EQ(result->yaws, expected.yaws);
    EXPECT_EQ(result->evaluations, expected.evaluations);
    EXPECT_EQ(result->result.fuzzy, expected.result.fuzzy);
  }
}

// Ipopt prints by itself, and reads ipopt.opt where the program runs; neither may happen.
class PathOptimizerFolder : public test::FolderTest {};

TEST_F(PathOptimizerFolder, IpoptIsSilentAndReadsNoFile) {
  Random random(9);
  const Scene scene = test::random_scene(random, 8, 200);
  PathOptimizerOptions limited;
  limited.max_yaw_rate = 0.8;
  const auto expected = optimize(scene);
  const auto home = std::filesystem::current_path();
  write("ipopt.opt", "print_level 5\nmax_iter 0\noutput_file ipopt.out\n");
  std::filesystem::current_path(folder_);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const auto turned = optimize(scene);
  (void)optimize(scene, limited);
  (void)optimize(scene, paper_optimizer_options());
  const auto out = testing::internal::GetCapturedStdout(), err = testing::internal::GetCapturedStderr();
  std::filesystem::current_path(home);
  EXPECT_EQ(out, "");
  EXPECT_EQ(err, "");
  EXPECT_FALSE(std::filesystem::exists(path("ipopt.out")));
  EXPECT_EQ(turned.yaws, expected.yaws);
}

}  // namespace
}  // namespace frontlux::planner
