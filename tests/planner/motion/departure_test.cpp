#include "motion/departure.hpp"

#include "planner/motion/within_limits.hpp"

#include <random>

namespace frontlux::planner {
namespace {

// A robot leaves one path for another at any moment, among obstacles that refuse most arcs: every corner may
// be one at which the old trajectory rests, or the new one.
TEST(Departure, KeepsTheLimitsFromOnePathToAnother) {
  std::mt19937_64 bits(3);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(bits);
  };
  int asked = 0;
  const SegmentTest mostly_straight = [&](const auto&, const auto&, const Eigen::Vector3d& deviation) {
    return deviation.isZero() || ++asked % 3 == 0;
  };
  int stopped = 0, went_on = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const MotionLimits limits{2.0, 3.0, 1.57, i % 2 == 0};
    const double reach = std::exp(number(std::log(0.1), std::log(5.0)));
    const auto place = [&] {
      return Pose{{number(-reach, reach), number(-reach, reach), number(-0.3, 0.3)}, number(-3.0, 3.0)};
    };
    const std::vector<Pose> way = {place(), place(), place(), place()}, then = {place(), place(), place()};
    const auto old = Trajectory::through({way.front()}, 0.0, way, limits, mostly_straight);
    ASSERT_TRUE(old);
    // Also when it has all but stopped.
    const double time =
        i % 5 == 0 ? old->end() - std::pow(10.0, number(-6.0, -3.0)) : number(0.0, old->end());
    const auto path_from = [&](const Pose& start) {
      std::vector<Pose> path = {start};
      path.insert(path.end(), then.begin(), then.end());
      return path;
    };
    const auto departure = detail::best_departure(*old, time, path_from, limits, mostly_straight);
    ASSERT_TRUE(departure);
    (departure->stops ? stopped : went_on) += 1;
    const Trajectory trajectory = detail::depart(*old, time, *departure, limits, mostly_straight);
    EXPECT_LT((trajectory.at(time).pose.position - old->at(time).pose.position).norm(), 1e-9);
    EXPECT_LT((trajectory.at(time).velocity - old->at(time).velocity).norm(), 1e-6);
    EXPECT_LT((trajectory.at(trajectory.end()).pose.position - then.back().position).norm(), 1e-9);
    test::expect_within(trajectory, limits, 0.002);
  }
  EXPECT_GT(stopped, 10);
  EXPECT_GT(went_on, 10);
}

// A robot at its full speed turns to a way that leads elsewhere. In the open it need not stop: on an arc of
// its widest useful radius it would lose no time at all.
TEST(Departure, TurnsElsewhereWithoutAStop) {
  const MotionLimits limits{1.5, 2.0, 1.0};
  const SegmentTest all_free = [](const auto&, const auto&, const auto&) { return true; };
  const std::vector<Pose> way = {Pose{}, Pose{{20.0, 0.0, 0.0}, 0.0}};
  const auto old = Trajectory::through({way.front()}, 0.0, way, limits, all_free);
  ASSERT_TRUE(old);
  constexpr double kTime = 5.0, kAway = 3.0, kStopping = 1.5 * 1.5 / (2 * 2.0);  // [s], [m], [m]
  for (const int degrees : {30, 45, 60, 75, 90}) {
    SCOPED_TRACE(degrees);
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d from = old->at(kTime).pose.position;
    const Pose goal{from + kAway * Eigen::Vector3d{std::cos(angle), std::sin(angle), 0.0}, 0.0};
    const auto path_from = [&](const Pose& start) { return std::vector<Pose>{start, goal}; };
    const auto departure = detail::best_departure(*old, kTime, path_from, limits, all_free);
    ASSERT_TRUE(departure);
    EXPECT_FALSE(departure->stops);
    const Trajectory trajectory = detail::depart(*old, kTime, *departure, limits, all_free);
    double slowest = limits.speed;
    for (double time = kTime; time < trajectory.end() - 1.0; time += 0.01)
      slowest = std::min(slowest, trajectory.at(time).velocity.norm());
    EXPECT_GT(slowest, degrees <= 60 ? 1.3 : 0.8);
    // Braking, and then going from rest to rest.
    const double rest = (goal.position - from - Eigen::Vector3d{kStopping, 0.0, 0.0}).norm();
    const double with_stop = 2 * limits.speed / limits.acceleration + rest / limits.speed;
    EXPECT_LT(trajectory.end() - kTime, with_stop - (degrees <= 60 ? 0.5 : 0.2));
  }
}

TEST(Departure, IsNoneWithoutAPath) {
  const Trajectory rest(Pose{}, 0.0);
  const auto nowhere = [](const Pose&) { return std::vector<Pose>{}; };
  EXPECT_FALSE(detail::best_departure(rest, 1.0, nowhere, {}, {}));
}

}  // namespace
}  // namespace frontlux::planner
