#include "planner/motion/within_limits.hpp"

#include <frontlux/planner/trajectory.hpp>

#include <random>

namespace frontlux::planner {
namespace {

using test::expect_within;

constexpr double kStep = 0.01;  // [s]

const SegmentTest kAllFree = [](const auto&, const auto&, const auto&) { return true; };
const SegmentTest kNothingFree = [](const auto&, const auto&, const auto&) { return false; };

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution(low, high)(bits_); }
  MotionLimits limits() {
    return {(*this)(0.3, 3.0), (*this)(0.5, 5.0), (*this)(0.3, 3.0), (*this)(0.0, 1.0) < 0.5};
  }
  std::vector<Pose> viewpoints() {
    const auto count = static_cast<int>((*this)(2.0, 9.0));
    const double reach = std::exp((*this)(std::log(0.05), std::log(20.0)));
    std::vector<Pose> viewpoints;
    for (int i = 0; i < count; ++i)
      viewpoints.push_back({{(*this)(-reach, reach), (*this)(-reach, reach), (*this)(-1.0, 1.0)},
                            (*this)(-std::numbers::pi, std::numbers::pi)});
    return viewpoints;
  }

 private:
  std::mt19937_64 bits_;
};

TEST(Trajectory, TakesAStraightWayAsFastAsItsLimitsAllow) {
  const std::vector<Pose> way = {{{0, 0, 1}, 0.0}, {{10, 0, 1}, 0.0}};
  const auto trajectory = Trajectory::through({way.front()}, 5.0, way, {2.0, 3.0, 1.0}, kAllFree);
  ASSERT_TRUE(trajectory);
  const double shortest = 10.0 / 2.0 + 2.0 / 3.0;
  EXPECT_DOUBLE_EQ(trajectory->begin(), 5.0);
  EXPECT_GE(trajectory->end() - 5.0, shortest - 1e-9);
  EXPECT_LE(trajectory->end() - 5.0, shortest * 1.005);
  EXPECT_DOUBLE_EQ(trajectory->length(), 10.0);
  EXPECT_NEAR(trajectory->at(5.0 + shortest / 2).velocity.x(), 2.0, 1e-9);
  EXPECT_EQ(trajectory->at(100.0).pose.position, way.back().position);
  EXPECT_EQ(trajectory->at(0.0).pose.position, way.front().position);
  EXPECT_TRUE(trajectory->at(100.0).velocity.isZero());
}

TEST(Trajectory, IsFasterOnDiagonalsWithLimitsForEachAxis) {
  const std::vector<Pose> way = {{{0, 0, 0}, 0.0}, {{8, 8, 0}, 0.0}};
  const MotionLimits limits{2.0, 3.0, 1.0, true};
  const auto trajectory = Trajectory::through({way.front()}, 0.0, way, limits, kAllFree);
  ASSERT_TRUE(trajectory);
  EXPECT_NEAR(trajectory->end(), 8.0 / 2.0 + 2.0 / 3.0, 0.03);
  expect_within(*trajectory, limits);
}

TEST(Trajectory, KeepsAllLimitsAtEveryMoment) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const MotionLimits limits = random.limits();
    const std::vector<Pose> way = random.viewpoints();
    const auto trajectory = Trajectory::through({way.front()}, 1.0, way, limits, kAllFree);
    ASSERT_TRUE(trajectory);
    expect_within(*trajectory, limits);
    EXPECT_LT((trajectory->at(trajectory->end()).pose.position - way.back().position).norm(), 1e-9);
    EXPECT_NEAR(
        std::remainder(trajectory->at(trajectory->end()).pose.yaw - way.back().yaw, 2 * std::numbers::pi),
        0.0, 1e-9);
  }
}

TEST(Trajectory, RoundsCornersOnlyWhereTheTestAllows) {
  const std::vector<Pose> way = {{{0, 0, 0}, 0}, {{4, 0, 0}, 0}, {{4, 4, 0}, 0}};
  const MotionLimits limits{1.5, 2.0, 1.0};
  const auto rounded = Trajectory::through({way.front()}, 0.0, way, limits, kAllFree),
             sharp = Trajectory::through({way.front()}, 0.0, way, limits, kNothingFree);
  ASSERT_TRUE(rounded && sharp);
  EXPECT_LT(rounded->length(), 8.0 - 0.3);
  EXPECT_DOUBLE_EQ(sharp->length(), 8.0);
  EXPECT_LT(rounded->end(), sharp->end() - 0.5);
  const auto nearest = [&](const Trajectory& trajectory) {
    double distance = std::numeric_limits<double>::infinity();
    for (double time = 0.0; time < trajectory.end(); time += kStep)
      distance = std::min(distance, (trajectory.at(time).pose.position - way[1].position).norm());
    return distance;
  };
  EXPECT_GT(nearest(*rounded), 0.1);
  EXPECT_LT(nearest(*sharp), 0.01);
  // The arc stays within what the test was asked for: chords, and how far the arc is from them.
  const SegmentTest seen = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                               const Eigen::Vector3d& deviation) {
    EXPECT_LE(deviation.maxCoeff(), 0.002);
    EXPECT_LE(std::max(from.x(), to.x()), 4.0 + 1e-9);
    EXPECT_GE(std::min(from.y(), to.y()), -1e-9);
    return true;
  };
  EXPECT_TRUE(Trajectory::through({way.front()}, 0.0, way, limits, seen));
}

// Viewpoints on the straight parts of a path are no corners: arcs are as wide as without them.
TEST(Trajectory, TakesCornersAsFastWithViewpointsBetweenThem) {
  const MotionLimits limits{1.5, 2.0, 3.0};
  const std::vector<Pose> corners = {{{0, 0, 0}, 0}, {{3, 0, 0}, 0}, {{3, 3, 0}, 0}, {{6, 6, 0}, 0}};
  std::vector<Pose> way = {corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i)
    for (int part = 1; part <= 5; ++part) {
      const Eigen::Vector3d from = corners[i - 1].position, to = corners[i].position;
      way.push_back({from + part / 5.0 * (to - from), 0.0});
    }
  const auto few = Trajectory::through({corners.front()}, 0.0, corners, limits, kAllFree),
             many = Trajectory::through({way.front()}, 0.0, way, limits, kAllFree);
  ASSERT_TRUE(few && many);
  EXPECT_NEAR(many->end(), few->end(), 1e-6);
  EXPECT_NEAR(many->length(), few->length(), 1e-6);
  expect_within(*many, limits);
}

// Also those that an arc cuts off: there it looks where their places on the corner's sides would have it.
TEST(Trajectory, LooksWhereItsViewpointsLook) {
  const MotionLimits limits{1.5, 2.0, 3.0};
  std::vector<Pose> way;
  for (int i = 0; i <= 12; ++i)  // a corner in the middle, with a yaw that follows the length
    way.push_back({{std::min(i, 6) * 0.5, std::max(i - 6, 0) * 0.5, 0.0}, 0.1 * i});
  const auto trajectory = Trajectory::through({way.front()}, 0.0, way, limits, kAllFree);
  ASSERT_TRUE(trajectory);
  EXPECT_LT(trajectory->length(), 5.9);
  double before = 0.0;
  for (double time = 0.0; time <= trajectory->end(); time += kStep) {
    const Pose pose = trajectory->at(time).pose;
    EXPECT_GE(pose.yaw, before - 1e-9);
    before = pose.yaw;
    // As by the nearer side of the corner: x up to the corner, then y.
    const double along = pose.position.x() + pose.position.y();
    EXPECT_NEAR(pose.yaw, 0.2 * along, 0.06) << time;
  }
}

TEST(Trajectory, TurnsAtTheEndIfThereIsNoTimeOnTheWay) {
  const std::vector<Pose> way = {{{0, 0, 0}, 0.0}, {{1, 0, 0}, 3.0}};
  const MotionLimits limits{2.0, 4.0, 0.5};
  const auto trajectory = Trajectory::through({way.front()}, 0.0, way, limits, kAllFree);
  ASSERT_TRUE(trajectory);
  EXPECT_NEAR(trajectory->end(), 3.0 / 0.5, 1e-9);
  EXPECT_NEAR(trajectory->at(6.0).pose.yaw, 3.0, 1e-9);
  expect_within(*trajectory, limits);
}

TEST(Trajectory, TurnsInPlace) {
  const Pose here{{1, 2, 3}, 1.0};
  const std::vector<Pose> way = {here, {here.position, -1.0}};
  const auto trajectory = Trajectory::through({here}, 0.0, way, {1.0, 1.0, 0.5}, kAllFree);
  ASSERT_TRUE(trajectory);
  EXPECT_NEAR(trajectory->end(), 4.0, 1e-9);
  EXPECT_EQ(trajectory->at(2.0).pose.position, here.position);
  EXPECT_NEAR(trajectory->at(2.0).pose.yaw, 0.0, 1e-9);
}

TEST(Trajectory, IsNoneForARobotThatIsTooFast) {
  const std::vector<Pose> way = {{{0, 0, 0}, 0}, {{0.3, 0, 0}, 0}};
  EXPECT_FALSE(Trajectory::through({way.front(), {2, 0, 0}}, 0.0, way, {2.0, 3.0, 1.0}, kAllFree));
  EXPECT_TRUE(Trajectory::through({way.front(), {1, 0, 0}}, 0.0, way, {2.0, 3.0, 1.0}, kAllFree));
}

// Its places lie on the curve of another, in its order.
void expect_on_curve(const Trajectory& trajectory, const Trajectory& curve) {
  double low = trajectory.begin();
  for (double time = low; time < trajectory.end() + kStep; time += kStep) {
    const Eigen::Vector3d place = trajectory.at(time).pose.position;
    // The curve's time at the place, which lies ahead of the one before.
    double high = low + 2 * kStep;
    for (int i = 0; i < 30; ++i) {
      const double middle = (low + high) / 2;
      const MotionState there = curve.at(middle);
      (there.velocity.dot(place - there.pose.position) > 0.0 ? low : high) = middle;
    }
    ASSERT_LT((curve.at(low).pose.position - place).norm(), 1e-6) << "at " << time;
  }
}

TEST(Trajectory, BrakesAsHardAsItMay) {
  const std::vector<Pose> path = {{{0, 0, 0}, 0.0}, {{10, 0, 0}, 0.0}};
  const MotionLimits limits{2.0, 3.0, 1.0};
  const auto old = Trajectory::through({path.front()}, 0.0, path, limits, kAllFree);
  ASSERT_TRUE(old);
  constexpr double kTime = 2.5, kBraking = 2.0 / 3.0, kDistance = 2.0 * 2.0 / (2 * 3.0);  // [s], [s], [m]
  ASSERT_NEAR(old->at(kTime).velocity.x(), limits.speed, 1e-9);
  const Trajectory stop = old->after_stop(kTime, {}, limits, kAllFree);
  EXPECT_NEAR(stop.end(), kTime + kBraking, 0.005);
  EXPECT_NEAR(stop.length(), kDistance, 0.005);
  EXPECT_NEAR(old->stop(kTime, limits).position.x(), old->at(kTime).pose.position.x() + kDistance, 0.005);
  expect_within(stop, limits);
}

TEST(Trajectory, GoesOnFromAnotherWithoutAJump) {
  Random random(2);
  int sooner = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const MotionLimits limits = random.limits();
    const std::vector<Pose> way = random.viewpoints();
    const auto old = Trajectory::through({way.front()}, 0.0, way, limits, kAllFree);
    ASSERT_TRUE(old);
    const double time = random(0.0, 1.1) * old->end();
    std::vector<Pose> next = random.viewpoints();
    next.insert(next.begin(), old->stop(time, limits));
    const Trajectory trajectory = old->after_stop(time, next, limits, kAllFree);
    EXPECT_EQ(trajectory.begin(), time);
    EXPECT_LT((trajectory.at(time).pose.position - old->at(time).pose.position).norm(), 1e-9);
    EXPECT_LT((trajectory.at(time).velocity - old->at(time).velocity).norm(), 1e-6 * limits.speed);
    expect_within(trajectory, limits);
    EXPECT_LT((trajectory.at(trajectory.end()).pose.position - next.back().position).norm(), 1e-9);
    // It brakes at once: not after the old one's end, and on its curve.
    const Trajectory stop = old->after_stop(time, {}, limits, kAllFree);
    EXPECT_LE(stop.end(), std::max(time, old->end()) + 1e-9);
    EXPECT_LE(stop.length(), old->length());
    expect_on_curve(stop, *old);
    expect_within(stop, limits);
    const Eigen::Vector3d rest = old->stop(time, limits).position;
    EXPECT_LT((rest - stop.end_pose().position).norm(), 1e-9);
    sooner += stop.end() < old->end() - 0.1 ? 1 : 0;
  }
  EXPECT_GT(sooner, 50);
}

TEST(Trajectory, StopAndGoTakesTheTimeOfEachPart) {
  const std::vector<Pose> way = {{{0, 0, 0}, 0}, {{3, 0, 0}, 0}, {{3, 0, 0}, 1.0}, {{3, 3, 0}, 1.0}};
  const MotionLimits limits{1.0, 2.0, 0.5};
  EXPECT_NEAR(stop_and_go_time(way, limits), 3.5 + 2.0 + 3.5, 0.05);
  EXPECT_EQ(stop_and_go_time(std::span(way).first(1), limits), 0.0);
  EXPECT_EQ(stop_and_go_time({}, limits), 0.0);
}

TEST(Trajectory, RefusesAWayThatIsTooLong) {
  const auto along_x = [](double x) { return Pose{{x, 0, 0}, 0}; };
  const auto through = [](const std::vector<Pose>& poses) {
    return Trajectory::through({poses.front()}, 0, poses, {}, kAllFree);
  };
  EXPECT_NEAR(through({along_x(0), along_x(6e4), along_x(9e4)})->length(), 9e4, 1e-6);
  EXPECT_THROW(static_cast<void>(through({along_x(0), along_x(6e4), along_x(0)})), std::length_error);
  EXPECT_THROW(static_cast<void>(through({along_x(0), along_x(1e300)})), std::length_error);
  EXPECT_THROW(static_cast<void>(through({along_x(-1e308), along_x(1e308)})), std::length_error);
}

TEST(Trajectory, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose here;
  const std::vector<Pose> way = {here, {{nan, 0, 0}, 0}};
  EXPECT_THROW(static_cast<void>(Trajectory::through({here}, 0.0, way, {}, kAllFree)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Trajectory::through({here}, 0.0, {}, {}, kAllFree)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Trajectory(here, nan)), std::invalid_argument);
  EXPECT_THROW(MotionLimits{.speed = 0.0}.check(), std::invalid_argument);
  EXPECT_THROW(MotionLimits{.acceleration = -1.0}.check(), std::invalid_argument);
  EXPECT_THROW(MotionLimits{.yaw_rate = nan}.check(), std::invalid_argument);
}

}  // namespace
}  // namespace frontlux::planner
