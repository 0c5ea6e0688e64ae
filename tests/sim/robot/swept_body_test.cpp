// Round bodies against points all over triangles.

#include "support/random.hpp"

#include <frontlux/sim/swept_body.hpp>

namespace frontlux::sim {
namespace {

using Eigen::Vector3d;
using frontlux::test::Random;
using planner::BodyShape;

// By how much a body of this size would have to grow on all sides to hold a point [m]; below 0 if it does.
double distance_from(BodyShape shape, const Vector3d& half, const Vector3d& point) {
  if (shape == BodyShape::kSphere) return point.norm() - half.x();
  return std::max(point.head<2>().norm() - half.x(), std::abs(point.z()) - half.z());
}

// The least of the points of a triangle, each at most so far from the next.
double distance_from(BodyShape shape, const Vector3d& half, const std::array<Vector3d, 3>& triangle,
                     int points) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= points; ++i)
    for (int j = 0; i + j <= points; ++j) {
      const double a = static_cast<double>(i) / points, b = static_cast<double>(j) / points;
      const Vector3d point = triangle[0] + a * (triangle[1] - triangle[0]) + b * (triangle[2] - triangle[0]);
      least = std::min(least, distance_from(shape, half, point));
    }
  return least;
}

TEST(SweptBody, RoundOnesMeetTheTrianglesWhosePointsTheyHold) {
  Random random(11);
  int met = 0, passed = 0, corners = 0;
  constexpr int kPoints = 60;
  for (int i = 0; i < 6'000; ++i) {
    const BodyShape shape = i % 2 == 0 ? BodyShape::kCylinder : BodyShape::kSphere;
    const double radius = random.uniform(0.05, 0.5);
    const Vector3d half(radius, radius, shape == BodyShape::kSphere ? radius : random.uniform(0.05, 0.5));
    std::array<Vector3d, 3> triangle{random.point(-1, 1), random.point(-1, 1), random.point(-1, 1)};
    if (random.one_in(3))  // a large one, as walls are
      for (Vector3d& corner : triangle) corner *= 3.0;
    if (random.one_in(4)) triangle[1].z() = triangle[2].z() = triangle[0].z();
    if (random.one_in(4)) triangle[1].head<2>() = triangle[0].head<2>();  // upright
    if (random.one_in(10)) triangle[2] = triangle[1];
    const Vector3d at = random.point(-0.5, 0.5);
    const std::array<Vector3d, 3> seen{triangle[0] - at, triangle[1] - at, triangle[2] - at};
    const double least = distance_from(shape, half, seen, kPoints);
    // No point of the triangle is farther from one of these than this.
    double apart = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      apart = std::max(apart, (triangle[k] - triangle[(k + 1) % 3]).norm() / kPoints);
    const bool touches = SweptBody(shape, {at - half, at + half}, Vector3d::Zero()).touches(triangle);
    if (least <= 0.0) {
      ASSERT_TRUE(touches) << "case " << i;
    }
    if (touches) {
      ASSERT_LE(least, apart) << "case " << i;
    }
    met += touches ? 1 : 0;
    passed += least > apart ? 1 : 0;
    corners += !touches && SweptBox({at - half, at + half}, Vector3d::Zero()).touches(triangle) ? 1 : 0;
  }
  EXPECT_GT(met, 1'000);
  EXPECT_GT(passed, 1'000);
  EXPECT_GT(corners, 300) << "the box around them is not what decides";
}

// What a body that is a millimetre smaller meets somewhere on the motion, with its inside or its rim, the
// body meets; and what it meets, one that is a millimetre larger does at some of these places.
TEST(SweptBody, RoundOnesMeetWhatTheyMeetOnTheirMotion) {
  Random random(12);
  int met = 0, only_between = 0, without_corners = 0;
  for (int i = 0; i < 3'000; ++i) {
    const BodyShape shape = i % 2 == 0 ? BodyShape::kCylinder : BodyShape::kSphere;
    // Small ones leave a place as soon as they have come to it.
    const double radius = random.one_in(2) ? random.uniform(0.05, 0.3) : random.uniform(0.004, 0.02);
    const Vector3d half = Vector3d::Constant(radius), at = random.point(-0.5, 0.5),
                   motion = random.point(-0.5, 0.5);
    const std::array<Vector3d, 3> triangle{random.point(-1, 1), random.point(-1, 1), random.point(-1, 1)};
    constexpr int kSteps = 500;  // less than 2 mm apart
    const auto to = [&](int step) -> Vector3d { return at + motion * (static_cast<double>(step) / kSteps); };
    const auto meets_at = [&](int step, double larger) {
      const Vector3d all = half + Vector3d::Constant(larger);
      return SweptBody(shape, {to(step) - all, to(step) + all}, Vector3d::Zero()).touches(triangle);
    };
    const auto meets = [&](double larger) {
      for (int step = 0; step <= kSteps; ++step)
        if (meets_at(step, larger)) return true;
      return false;
    };
    const bool touches = SweptBody(shape, {at - half, at + half}, motion).touches(triangle);
    const bool surely = meets(-1e-3);
    ASSERT_TRUE(touches || !surely) << "case " << i;
    ASSERT_TRUE(!touches || meets(1e-3)) << "case " << i;
    met += surely ? 1 : 0;
    only_between += surely && !meets_at(0, 0.0) && !meets_at(kSteps, 0.0) ? 1 : 0;
    const auto holds_corner = [&](int step) {
      return std::ranges::any_of(triangle, [&](const Vector3d& corner) {
        return distance_from(shape, half, corner - to(step)) <= 0.0;
      });
    };
    bool corner = false;
    for (int step = 0; step <= kSteps; ++step) corner = corner || holds_corner(step);
    without_corners += surely && !corner ? 1 : 0;
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(only_between, 30);
  EXPECT_GT(without_corners, 30);
}

TEST(SweptBody, OfABoxIsTheSweptBox) {
  Random random(13);
  for (int i = 0; i < 500; ++i) {
    const Vector3d half = random.point(0.05, 0.4), at = random.point(-1, 1), motion = random.point(-1, 1);
    const std::array<Vector3d, 3> triangle{random.point(-2, 2), random.point(-2, 2), random.point(-2, 2)};
    EXPECT_EQ(SweptBody(BodyShape::kBox, {at - half, at + half}, motion).touches(triangle),
              SweptBox({at - half, at + half}, motion).touches(triangle));
  }
}

// Exactly: beside an upright edge, over a flat square, and where a slanting wall leaves its height.
TEST(SweptBody, MeetsByItsExactDistance) {
  const auto touches = [](BodyShape shape, const Vector3d& half, const Vector3d& at,
                          const std::array<Vector3d, 3>& triangle) {
    return SweptBody(shape, {at - half, at + half}, Vector3d::Zero()).touches(triangle);
  };
  const std::array<Vector3d, 3> upright{Vector3d(0, 0, -1), Vector3d(0, 0, 1), Vector3d(1, 1, 0)};
  const std::array<Vector3d, 3> flat{Vector3d(-5, -5, 0), Vector3d(5, -5, 0), Vector3d(0, 5, 0)};
  for (const double off : {-1e-6, 1e-6}) {
    const double radius = 0.5 + off;
    const bool meets = off > 0.0;
    EXPECT_EQ(touches(BodyShape::kCylinder, {radius, radius, 0.2}, {-0.3, -0.4, 0}, upright), meets);
    EXPECT_EQ(touches(BodyShape::kSphere, Vector3d::Constant(radius), {-0.3, -0.4, 0}, upright), meets);
    EXPECT_EQ(touches(BodyShape::kCylinder, {0.1, 0.1, radius}, {0, 0, 0.5}, flat), meets);
    EXPECT_EQ(touches(BodyShape::kSphere, Vector3d::Constant(radius), {0, 0, 0.5}, flat), meets);
    // A wall at 45 degrees, 1.05 m off where the cylinder ends above.
    const std::array<Vector3d, 3> slanting{Vector3d(0.75, -9, 0.5), Vector3d(0.75, 9, 0.5),
                                           Vector3d(9.75, 0, -8.5)};
    EXPECT_EQ(touches(BodyShape::kCylinder, {radius, radius, 0.2}, {0.55, 0, 0}, slanting), meets);
  }
}

}  // namespace
}  // namespace frontlux::sim
