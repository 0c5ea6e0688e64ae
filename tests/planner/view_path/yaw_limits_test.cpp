#include "view_path/yaw_limits.hpp"

#include "motion/yaw.hpp"
#include "support/random.hpp"

namespace frontlux::planner {
namespace {

constexpr double kPi = std::numbers::pi, kInfinity = std::numeric_limits<double>::infinity();

TEST(YawLimits, AreRateTimesLength) {
  const std::vector<Pose> path{{{0, 0, 0}, 0}, {{0, 2, 0}, 0}, {{0, 2, 0}, 0}, {{9, 2, 0}, 0}};
  const YawLimits limits(path, 0.25);
  ASSERT_TRUE(limits.limited());
  EXPECT_EQ(limits.step(0), 0.5);
  EXPECT_EQ(limits.step(1), 0.0);  // no length, no turn
  EXPECT_EQ(limits.step(2), 2.25);
  EXPECT_TRUE(limits.allows(std::vector{1.0, 1.5, 1.5 + 2 * kPi, -0.75}));  // whole turns make no difference
  EXPECT_FALSE(limits.allows(std::vector{1.0, 1.5, 1.5, -0.8}));
  EXPECT_FALSE(limits.allows(std::vector{1.0, 1.5, 1.6, 1.6}));

  // From half a turn on there is no limit, nor without any.
  const YawLimits free(path, kInfinity);
  EXPECT_FALSE(free.limited());
  EXPECT_TRUE(free.allows(std::vector{0.0, 3.0, -3.0, 0.0}));
  EXPECT_EQ(YawLimits(path, kPi / 2).step(0), kInfinity);
  EXPECT_EQ(YawLimits(path, 1.0).step(2), kInfinity);  // 9 rad
  EXPECT_FALSE(YawLimits({path.data(), 1}, 0.1).limited());
}

TEST(YawLimits, EvenTurnUsesTheSameFractionOfEachLimit) {
  test::Random random(1);
  int reachable = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<Pose> path(static_cast<std::size_t>(2 + random.below(6)));
    for (Pose& pose : path) pose.position = {random.uniform(0, 3), random.uniform(0, 3), 0};
    const YawLimits limits(path, random.uniform(0.1, 1.0));
    const double first = random.uniform(-9, 9), last = random.uniform(-9, 9);
    const auto yaws = limits.even_turn(first, last);
    ASSERT_EQ(yaws.size(), path.size());
    EXPECT_EQ(yaws.front(), first);
    EXPECT_EQ(yaws.back(), last);
    std::vector<double> steps;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) steps.push_back(std::min(limits.step(i), kPi));
    const double all = std::accumulate(steps.begin(), steps.end(), 0.0);
    const double turn = std::remainder(last - first, 2 * kPi);
    for (std::size_t i = 0; i < steps.size(); ++i)
      EXPECT_NEAR(detail::wrapped(yaws[i + 1] - yaws[i] - turn * steps[i] / all), 0.0, 1e-12);
    EXPECT_EQ(limits.allows(yaws), std::fabs(turn) <= all);
    reachable += limits.allows(yaws) ? 1 : 0;
  }
  EXPECT_GT(reachable, 100);
  EXPECT_LT(reachable, 480);
}

}  // namespace
}  // namespace frontlux::planner
