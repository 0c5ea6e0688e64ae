#include "robot/round_body.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace frontlux::sim {
namespace {

constexpr double kOnEdge = 1e-9;  // [m] so near to an edge the distance from the edge decides

// What is left of a triangle, of which each of two cuts adds a corner at most.
struct Polygon {
  std::array<Eigen::Vector3d, 5> corners;
  std::size_t size = 0;

  void add(const Eigen::Vector3d& corner) { corners[size++] = corner; }
  [[nodiscard]] const Eigen::Vector3d& after(std::size_t i) const { return corners[(i + 1) % size]; }
};

// What of a polygon is not above a height, or with `sign` -1 not below its negative.
Polygon cut(const Polygon& polygon, double sign, double height) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Eigen::Vector3d &a = polygon.corners[i], &b = polygon.after(i);
    const double over_a = sign * a.z() - height, over_b = sign * b.z() - height;
    if (over_a <= 0.0) kept.add(a);
    if ((over_a < 0.0 && over_b > 0.0) || (over_a > 0.0 && over_b < 0.0))
      kept.add(a + (b - a) * (over_a / (over_a - over_b)));
  }
  return kept;
}

// From the origin to a segment, squared.
template <class Point>
double squared_distance(const Point& a, const Point& b) {
  const Point along = b - a;
  const double length = along.squaredNorm();
  const double part = length > 0.0 ? std::clamp(-a.dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + part * along).squaredNorm();
}

// Whether the z axis meets a triangle, off its edges, within a height above and below the origin.
bool axis_meets(const Triangle& triangle, double height) {
  std::array<double, 3> areas{};  // as seen from above, between the axis and the side opposite to a corner
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d a = triangle[(i + 1) % 3].head<2>(), b = triangle[(i + 2) % 3].head<2>();
    areas[i] = a.x() * b.y() - a.y() * b.x();
    if (std::abs(areas[i]) <= kOnEdge * (b - a).norm() || (areas[i] > 0.0) != (areas[0] > 0.0)) return false;
  }
  double z = 0.0;
  for (std::size_t i = 0; i < 3; ++i) z += areas[i] / (areas[0] + areas[1] + areas[2]) * triangle[i].z();
  const auto [low, high] = std::minmax({triangle[0].z(), triangle[1].z(), triangle[2].z()});
  return std::abs(std::clamp(z, low, high)) <= height;
}

}  // namespace

bool cylinder_touches(double radius, double half_height, const Triangle& triangle) {
  Polygon polygon;
  for (const Eigen::Vector3d& corner : triangle) polygon.add(corner);
  polygon = cut(cut(polygon, 1.0, half_height), -1.0, half_height);
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Eigen::Vector2d a = polygon.corners[i].head<2>(), b = polygon.after(i).head<2>();
    if (squared_distance(a, b) <= radius * radius) return true;
  }
  return axis_meets(triangle, half_height);
}

bool sphere_touches(double radius, const Triangle& triangle) {
  constexpr double kThin = 1e-12;  // of the length, below which a triangle is no more than its sides
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d &a = triangle[i], &b = triangle[(i + 1) % 3];
    if (squared_distance(a, b) <= radius * radius) return true;
    longest = std::max(longest, (b - a).norm());
  }
  const Eigen::Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  if (normal.norm() <= kThin * longest * longest) return false;
  for (std::size_t i = 0; i < 3; ++i)
    if (normal.dot(triangle[i].cross(triangle[(i + 1) % 3])) < 0.0) return false;
  return std::abs(normal.dot(triangle[0])) <= radius * normal.norm();
}

}  // namespace frontlux::sim
