#include "path/polyline.hpp"

#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

using test::Random;

Polyline random_path(Random& random, int points) {
  Polyline path;
  for (int i = 0; i < points; ++i)
    path.emplace_back(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-1, 1));
  return path;
}

TEST(Polyline, IsDividedEvenlyOnEverySegment) {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const Polyline path = random_path(random, 1 + random.below(6));
    const double spacing = random.uniform(0.1, 4.0);
    const Polyline points = divided(path, spacing);
    std::size_t at = 0;
    ASSERT_EQ(points[0], path[0]);
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Eigen::Vector3d segment = path[i] - path[i - 1];
      const auto parts = static_cast<std::size_t>(std::ceil(segment.norm() / spacing));
      for (std::size_t k = 1; k <= parts; ++k)
        ASSERT_LT(
            (points[at + k] - path[i - 1] - segment * static_cast<double>(k) / static_cast<double>(parts))
                .norm(),
            1e-12);
      at += parts;
      ASSERT_EQ(points[at], path[i]);
    }
    ASSERT_EQ(at + 1, points.size());
    EXPECT_NEAR(length_of(points), length_of(path), 1e-9);
  }
  // 0.3 + 0.9 is a little more than 1.2.
  EXPECT_EQ(divided({{0, 0, 0}, {0.3 + 0.9, 0, 0}}, 1.2).size(), 2U);
}

// Around a pillar of radius 1 at the origin.
bool is_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector2d a = from.head<2>(), d = (to - from).head<2>();
  const double t = d.squaredNorm() == 0.0 ? 0.0 : std::clamp(-a.dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (a + t * d).norm() >= 1.0;
}

TEST(Polyline, IsShortenedAroundAnObstacle) {
  Random random(2);
  int shorter = 0, straight = 0;
  for (int round = 0; round < 100; ++round) {
    Polyline path;
    while (path.size() < 6) {
      const Eigen::Vector3d point = random_path(random, 1)[0];
      if (path.empty() ? is_free(point, point) : is_free(path.back(), point)) path.push_back(point);
    }
    EXPECT_EQ(shortened(path, 0.2, 0, is_free), path);
    const Polyline result = shortened(path, 0.2, 6, is_free);
    ASSERT_EQ(result.front(), path.front());
    ASSERT_EQ(result.back(), path.back());
    for (std::size_t i = 1; i < result.size(); ++i) ASSERT_TRUE(is_free(result[i - 1], result[i]));
    const double direct = (path.back() - path.front()).norm();
    ASSERT_LE(length_of(result), length_of(path) + 1e-9);
    if (is_free(path.front(), path.back())) {
      EXPECT_EQ(result.size(), 2U);
      ++straight;
    } else {
      // A detour of less than half the pillar's circumference, and what the points' spacing adds.
      EXPECT_LT(length_of(result), direct + 3.2 + 1.0);
    }
    shorter += static_cast<int>(length_of(result) < 0.8 * length_of(path));
  }
  EXPECT_GT(shorter, 60);
  EXPECT_GT(straight, 20);
  EXPECT_LT(straight, 90);  // both cases occur
}

}  // namespace
}  // namespace frontlux::planner::detail
