// Robots that keep apart, against samples a hundred times as fine.

#include "motion/separation.hpp"

#include "support/random.hpp"

namespace frontlux::planner {
namespace {

using Eigen::AlignedBox3d, Eigen::Vector3d;
using test::Random;

const SegmentTest kAllFree = [](const auto&, const auto&, const auto&) { return true; };

AlignedBox3d cube(double edge) { return {Vector3d::Constant(-edge / 2), Vector3d::Constant(edge / 2)}; }

Trajectory straight(const Vector3d& from, const Vector3d& to, double time, const MotionLimits& limits) {
  const std::vector<Pose> way = {{from, 0.0}, {to, 0.0}};
  return Trajectory::through({way.front()}, time, way, limits, kAllFree).value();
}

TEST(Separation, GapIsThatOfTheFarthestAxis) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d at = random.point(-2, 2), half = random.point(0.05, 1);
    const AlignedBox3d a = cube(0.5), b(at - half, at + half);
    const double gap = detail::gap_between(a, b);
    EXPECT_EQ(gap, detail::gap_between(b, a));
    // Grown by half of it to all sides the boxes begin to touch.
    const auto touch = [&](double by) {
      const Vector3d more = Vector3d::Constant(by / 2);
      return AlignedBox3d(a.min() - more, a.max() + more)
          .intersects(AlignedBox3d(b.min() - more, b.max() + more));
    };
    EXPECT_TRUE(touch(gap + 1e-9));
    EXPECT_FALSE(gap > 0.0 && touch(gap - 1e-9));
  }
}

TEST(Separation, PositionsTooNearAreThoseWithASmallGap) {
  Random random(2);
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    const AlignedBox3d body = {-random.point(0.1, 0.6), random.point(0.1, 0.6)},
                       other = {-random.point(0.1, 0.6), random.point(0.1, 0.6)};
    const Vector3d other_at = random.point(-3, 3), at = other_at + random.point(-1.5, 1.5);
    const double gap = random.uniform(0, 0.5);
    const AlignedBox3d near = detail::positions_too_near(body, other, other_at, gap);
    const double actual = detail::gap_between(body.translated(at), other.translated(other_at));
    if (std::abs(actual - gap) < 1e-9) continue;
    EXPECT_EQ(near.contains(at), actual < gap);
    inside += near.contains(at) ? 1 : 0;
  }
  EXPECT_GT(inside, 500);
}

TEST(Separation, FollowsTheNextTrajectoryFromItsBeginOn) {
  const MotionLimits limits;
  const detail::RobotMotion robot{straight({0, 0, 0}, {4, 0, 0}, 0.0, limits),
                                  straight({9, 9, 9}, {9, 9, 0}, 2.0, limits)};
  EXPECT_LT(robot.at(1.99).pose.position.x(), 4.0);
  EXPECT_EQ(robot.at(2.0).pose.position, Vector3d(9, 9, 9));
  EXPECT_EQ(robot.last().begin(), 2.0);
}

// The least gap of two robots from a time on, by very many samples.
double least_gap(const Trajectory& a, const AlignedBox3d& body, const detail::RobotMotion& b,
                 const AlignedBox3d& other_body) {
  constexpr double kFine = 1e-3;  // [s]
  double least = std::numeric_limits<double>::infinity();
  const double end = std::max(a.end(), b.last().end());
  for (double time = a.begin(); time <= end + kFine; time += kFine)
    least = std::min(least, detail::gap_between(body.translated(a.at(time).pose.position),
                                                other_body.translated(b.at(time).pose.position)));
  return least;
}

TEST(Separation, IsThatOfManySamples) {
  Random random(3);
  constexpr double kGap = 0.1;
  int kept = 0, lost = 0, passed = 0;
  for (int i = 0; i < 900; ++i) {
    SCOPED_TRACE(i);
    double fastest = 0.0;
    const auto limits = [&] {
      const MotionLimits drawn{random.uniform(0.5, 2), random.uniform(1, 4), 1.0};
      fastest = std::max(fastest, drawn.speed);
      return drawn;
    };
    const auto point = [&] { return random.point(-2, 2); };
    const AlignedBox3d body = cube(random.uniform(0.2, 0.8)), other_body = cube(random.uniform(0.2, 0.8));
    const Trajectory mine = straight(point(), point(), random.uniform(0, 2), limits());
    detail::RobotMotion other{straight(point(), point(), 0.0, limits())};
    if (random.one_in(2)) {
      // From where it is resting by then: trajectories have no jumps.
      const Vector3d from = other.now.at(other.now.end()).pose.position;
      other.next = straight(from, point(), other.now.end() + random.uniform(0, 3), limits());
    }
    const double gap = least_gap(mine, body, other, other_body);
    const double first = detail::gap_between(body.translated(mine.at(mine.begin()).pose.position),
                                             other_body.translated(other.at(mine.begin()).pose.position));
    const bool keeps = detail::keeps_apart(mine, mine.begin(), body, other, other_body, kGap, 2 * fastest);
    const double least = std::min(kGap, first);
    // It is that to a millimetre, and between two of the many samples they come nearer by no more than two.
    if (std::abs(gap - least) < 0.003 && gap != first) continue;
    EXPECT_EQ(keeps, gap >= least - 1e-9) << gap << " of " << least;
    (keeps ? kept : lost) += 1;
    passed += first < kGap && keeps ? 1 : 0;
  }
  EXPECT_GT(kept, 50);
  EXPECT_GT(lost, 50);
  EXPECT_GT(passed, 3) << "robots that are too near, and part";
}

// Robots rest in the middle of voxels, and so often at the very distance that they have to keep.
TEST(Separation, PlacesThatAreJustFarEnoughAreFree) {
  for (int i = 1; i < 200; ++i) {
    const double at = (i + 0.5) * 0.3;
    const detail::RobotMotion other{Trajectory({{at, 0, 0}, 0.0}, 0.0)};
    const auto ends = [&](double x) { return straight({x - 1.0, 0, 0}, {x, 0, 0}, 0.0, {}); };
    EXPECT_TRUE(detail::keeps_apart(ends(at - 0.9), 0.0, cube(0.8), other, cube(0.8), 0.1, 2.0)) << i;
    EXPECT_FALSE(detail::keeps_apart(ends(at - 0.8999), 0.0, cube(0.8), other, cube(0.8), 0.1, 2.0)) << i;
  }
}

TEST(Separation, LooksAsFarAheadAsTheOtherMoves) {
  // A robot that has long arrived when the other one comes by.
  const MotionLimits limits;
  const Trajectory mine = straight({0, 0, 0}, {1, 0, 0}, 0.0, limits);
  const auto comes_to = [&](double x) {
    const std::vector<Pose> way = {{{20, 0, 0}, 0.0}, {{x, 0, 0}, 0.0}};
    return detail::RobotMotion{Trajectory({{20, 0, 0}, 0.0}, 0.0),
                               Trajectory::through({way.front()}, 10.0, way, limits, kAllFree).value()};
  };
  EXPECT_TRUE(detail::keeps_apart(mine, mine.begin(), cube(0.5), comes_to(1.7), cube(0.5), 0.1, 2.0));
  EXPECT_FALSE(detail::keeps_apart(mine, mine.begin(), cube(0.5), comes_to(1.5), cube(0.5), 0.1, 2.0));
  // One that rests does so for ever, whenever it was told: also where there are more steps than time.
  const auto rests_at = [](double x) { return detail::RobotMotion{Trajectory({{x, 0, 0}, 0.0}, 1e9)}; };
  EXPECT_TRUE(detail::keeps_apart(mine, mine.begin(), cube(0.5), rests_at(1.7), cube(0.5), 0.1, 2.0));
  EXPECT_FALSE(detail::keeps_apart(mine, mine.begin(), cube(0.5), rests_at(1.5), cube(0.5), 0.1, 2.0));
  // What was before does not matter.
  const Trajectory later = straight({1.0, 0, 0}, {0, 0, 0}, 60.0, limits);
  EXPECT_TRUE(detail::keeps_apart(later, later.begin(), cube(0.5), comes_to(1.7), cube(0.5), 0.1, 2.0));
}

}  // namespace
}  // namespace frontlux::planner
