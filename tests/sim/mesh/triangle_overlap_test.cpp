// Against clipping: what is left of the triangle after the box's six planes have cut it.

#include "mesh/triangle_overlap.hpp"

#include "support/random.hpp"

namespace frontlux::sim {
namespace {

bool clipping_leaves_something(std::vector<Eigen::Vector3d> polygon, const Eigen::AlignedBox3d& box) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const double plane = side < 0 ? box.min()[axis] : box.max()[axis];
      const auto outside = [&](const Eigen::Vector3d& point) { return side * (point[axis] - plane); };
      std::vector<Eigen::Vector3d> cut;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Eigen::Vector3d& a = polygon[i];
        const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
        if (outside(a) <= 0) cut.push_back(a);
        if ((outside(a) < 0 && outside(b) > 0) || (outside(a) > 0 && outside(b) < 0)) {
          Eigen::Vector3d crossing = a + (b - a) * outside(a) / (outside(a) - outside(b));
          crossing[axis] = plane;
          cut.push_back(crossing);
        }
      }
      polygon = cut;
    }
  }
  return !polygon.empty();
}

TriangleOverlap overlap_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return TriangleOverlap(std::array{a, b, c});
}

TEST(TriangleOverlap, AgreesWithClipping) {
  frontlux::test::Random random(1);
  const auto point = [&](double reach) {
    Eigen::Vector3d p = random.point(-reach, reach);
    if (random.one_in(3)) p = p.array().round();  // on planes of the box, and on each other
    return p;
  };
  std::size_t touching = 0, decided = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double reach = random.one_in(2) ? 2.0 : 6.0;
    const Eigen::Vector3d a = point(reach), b = point(reach), c = random.one_in(20) ? a : point(reach);
    const Eigen::Vector3d low = point(2.0);
    const Eigen::AlignedBox3d box(low, low + point(1.0).cwiseAbs() + Eigen::Vector3d::Constant(0.01));
    const Eigen::Vector3d hair = Eigen::Vector3d::Constant(1e-9);
    const bool surely = clipping_leaves_something({a, b, c}, {box.min() + hair, box.max() - hair});
    const bool maybe = clipping_leaves_something({a, b, c}, {box.min() - hair, box.max() + hair});
    const bool answer = overlap_of(a, b, c).touches(box);
    if (surely) {
      ASSERT_TRUE(answer) << i;
    }
    if (!maybe) {
      ASSERT_FALSE(answer) << i;
    }
    decided += surely == maybe ? 1 : 0;
    touching += surely ? 1 : 0;
  }
  EXPECT_GT(decided, 150'000U);
  EXPECT_GT(touching, 8'000U);
  EXPECT_LT(touching, 150'000U);
}

TEST(TriangleOverlap, BordersTouch) {
  const TriangleOverlap triangle = overlap_of({1, 0, 0}, {1, 1, 0}, {1, 0, 1});
  const Eigen::AlignedBox3d unit(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  EXPECT_TRUE(triangle.touches(unit));
  EXPECT_TRUE(triangle.touches({Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(2, 1, 1)}));
  EXPECT_TRUE(triangle.touches({Eigen::Vector3d(0.5, 0.5, 0.5), Eigen::Vector3d(1, 1, 1)}));  // at one point
  EXPECT_FALSE(triangle.touches({Eigen::Vector3d(0.5, 0.6, 0.5), Eigen::Vector3d(1, 1, 1)}));
  EXPECT_FALSE(triangle.touches({Eigen::Vector3d::Zero(), Eigen::Vector3d(0.99, 1, 1)}));
}

// Two edges, one of each, that pass each other closely: no face's normal separates them.
TEST(TriangleOverlap, SeparationAcrossEdges) {
  const Eigen::AlignedBox3d unit(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  for (const double gap : {-0.01, 0.01}) {
    const double k = 1.0 + gap / 2;  // the edge x + y = 2 k passes the box's edge x = y = 1
    const TriangleOverlap triangle =
        overlap_of({k + 1, k - 1, -0.5}, {k - 1, k + 1, 1.5}, {k + 2, k + 2, 0.5});
    EXPECT_EQ(triangle.touches(unit), gap < 0);
  }
}

}  // namespace
}  // namespace frontlux::sim
