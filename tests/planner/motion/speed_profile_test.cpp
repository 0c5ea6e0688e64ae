// Speeds along paths against closed formulas. With u = v^2 along s: du/ds = 2 a on a line and, on an arc of
// curvature k, du/ds = 2 sqrt(a^2 - (k u)^2), so u = a / k sin(2 k s) from rest on.

#include "motion/speed_profile.hpp"

#include "support/random.hpp"

#include <numbers>

namespace frontlux::planner {
namespace {

using test::Random;

PathPiece line(double length, const Eigen::Vector3d& direction = Eigen::Vector3d::UnitX()) {
  return {Eigen::Vector3d::Zero(), direction.normalized(), Eigen::Vector3d::Zero(), 0.0, length};
}
PathPiece arc(double radius, double angle) {
  return {Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), 1 / radius,
          radius * angle};
}

TEST(SpeedProfile, OfALineIsTheTextbooks) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const MotionLimits limits{random.uniform(0.2, 3), random.uniform(0.3, 5), 1.0};
    const double length = random.uniform(0.01, 8), shortest = limits.speed * limits.speed;
    const double first =
        random.uniform(0, 1) * std::min(limits.speed, std::sqrt(2 * limits.acceleration * length));
    const PathPiece piece = line(length, random.point(-1, 1));
    const auto nodes = detail::speed_profile({&piece, 1}, first, limits);
    ASSERT_GT(nodes.size(), 4U);
    EXPECT_EQ(nodes.front().along, 0.0);
    EXPECT_NEAR(nodes.back().along, length, 1e-12);
    for (const detail::SpeedNode& node : nodes) {
      const double faster = first * first + 2 * limits.acceleration * node.along,
                   slower = 2 * limits.acceleration * (length - node.along);
      EXPECT_NEAR(node.speed * node.speed, std::max(std::min({faster, slower, shortest}), 0.0), 1e-9);
    }
  }
}

TEST(SpeedProfile, HasLimitsForEachAxisOnALine) {
  const PathPiece diagonal = line(30.0, {1, -1, 0});
  const MotionLimits limits{2.0, 1.0, 1.0, true};
  double most = 0.0;
  const auto nodes = detail::speed_profile({&diagonal, 1}, 0.0, limits);
  for (const detail::SpeedNode& node : nodes) most = std::max(most, node.speed);
  EXPECT_NEAR(most, 2 * std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(nodes[1].speed * nodes[1].speed, 2 * std::numbers::sqrt2 * nodes[1].along, 1e-9);
}

// Never faster than the formula allows, and hardly slower.
TEST(SpeedProfile, GainsSpeedOnAnArcWithWhatTheCurveLeaves) {
  constexpr double kRadius = 1.5, kAcceleration = 2.0;
  const MotionLimits limits{100.0, kAcceleration, 1.0};
  const std::vector<PathPiece> path = {arc(kRadius, 1.0), line(50.0)};
  const auto nodes = detail::speed_profile(path, 0.0, limits);
  int counted = 0;
  for (const detail::SpeedNode& node : nodes) {
    if (node.along > path[0].length) continue;
    const double most =
        kAcceleration * kRadius * std::sin(std::min(2 * node.along / kRadius, std::numbers::pi / 2));
    EXPECT_LE(node.speed * node.speed, most * (1 + 1e-9));
    if (node.along > 0.6 * kRadius) continue;
    EXPECT_GE(node.speed * node.speed, most * 0.97);
    ++counted;
  }
  EXPECT_GT(counted, 9);
}

TEST(SpeedProfile, SlowsDownForWhatComes) {
  const std::vector<PathPiece> path = {line(5.0), arc(0.2, 1.0), line(5.0)};
  const MotionLimits limits{2.0, 2.0, 1.0};
  const auto nodes = detail::speed_profile(path, 0.0, limits);
  const double corner = std::sqrt(2.0 * 0.2);
  double most = 0.0;
  for (const detail::SpeedNode& node : nodes) {
    most = std::max(most, node.speed);
    EXPECT_TRUE(node.along < 5.0 || node.along > 5.2 || node.speed <= corner * (1 + 1e-9)) << node.along;
  }
  EXPECT_NEAR(most, 2.0, 1e-9);
  EXPECT_EQ(nodes.back().speed, 0.0);
}

// Everywhere: along the path and across it together.
TEST(SpeedProfile, KeepsTheAccelerationOnAnyPath) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const MotionLimits limits{random.uniform(0.2, 3), random.uniform(0.3, 5), 1.0};
    std::vector<PathPiece> path;
    for (int n = 1 + random.below(6); n > 0; --n) {
      path.push_back(line(random.uniform(0.001, 3)));
      path.push_back(arc(random.uniform(0.005, 2), random.uniform(0.01, 3)));
    }
    std::size_t piece = 0;
    double end = path[0].length;
    const auto nodes = detail::speed_profile(path, 0.0, limits);
    ASSERT_FALSE(nodes.empty());
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      const auto& [from, slow] = nodes[k - 1];
      const auto& [to, fast] = nodes[k];
      while (from > end - 1e-12 && piece + 1 < path.size()) end += path[++piece].length;
      const double along = (fast * fast - slow * slow) / (2 * (to - from)),
                   across = path[piece].curvature * std::pow(std::max(slow, fast), 2);
      EXPECT_LE(std::hypot(along, across), limits.acceleration * (1 + 1e-6));
      EXPECT_LE(fast, limits.speed * (1 + 1e-9));
      EXPECT_GT(slow + fast, 0.0) << "it would never get there";
    }
  }
}

TEST(SpeedProfile, IsNoneIfItCannotGetSlowEnough) {
  const PathPiece short_line = line(1.0);
  const MotionLimits limits{3.0, 2.0, 1.0};
  EXPECT_FALSE(detail::speed_profile({&short_line, 1}, 1.999, limits).empty());
  EXPECT_TRUE(detail::speed_profile({&short_line, 1}, 2.001, limits).empty());
  const std::vector<PathPiece> corner = {line(0.5), arc(0.05, 1.5), line(3.0)};
  EXPECT_TRUE(detail::speed_profile(corner, 1.6, limits).empty());
  EXPECT_EQ(detail::speed_profile({}, 0.0, limits).size(), 1U);
}

TEST(BrakingDistance, IsTheTextbooks) {
  const PathPiece way = line(100.0);
  for (const double speed : {0.0, 0.1, 1.0, 4.0}) {
    const double shortest = speed * speed / (2 * 2.5);
    const double distance = detail::braking_distance({&way, 1}, speed, {5.0, 2.5, 1.0});
    EXPECT_GE(distance, shortest);
    EXPECT_LE(distance, shortest * 1.01);
  }
  const PathPiece end = line(0.3);
  EXPECT_DOUBLE_EQ(detail::braking_distance({&end, 1}, 4.0, {5.0, 2.5, 1.0}), 0.3);
}

// u = a / k sin(2 k s): half a right angle of the arc stops the fastest robot that can take it.
TEST(BrakingDistance, OnAnArcIsWhatTheCurveLeaves) {
  constexpr double kRadius = 2.0, kAcceleration = 2.0;
  const PathPiece way = arc(kRadius, 3.0);
  const MotionLimits limits{2.0, kAcceleration, 1.0};
  const double fastest = std::sqrt(kAcceleration * kRadius);
  for (const double part : {0.2, 0.5, 0.8, 0.9, 0.95}) {
    SCOPED_TRACE(part);
    const double speed = part * fastest;
    const double shortest = kRadius / 2 * std::asin(part * part);
    const double distance = detail::braking_distance({&way, 1}, speed, limits);
    EXPECT_GE(distance, shortest);
    EXPECT_LE(distance, shortest * 1.25);
    const PathPiece part_of_it = arc(kRadius, distance / kRadius);
    EXPECT_FALSE(detail::speed_profile({&part_of_it, 1}, speed, limits).empty());
  }
  // As fast as it takes arcs, it can also brake on them.
  const std::vector<PathPiece> path = {line(5.0), way, line(5.0)};
  double cruise = 0.0;
  for (const auto& [along, speed] : detail::speed_profile(path, 0.0, limits))
    if (along > 6.0 && along < 7.0) cruise = std::max(cruise, speed);
  EXPECT_GT(cruise, 0.95 * fastest);
  EXPECT_LT(detail::braking_distance({&way, 1}, cruise, limits), kRadius);
}

}  // namespace
}  // namespace frontlux::planner
