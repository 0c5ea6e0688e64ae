#include "mesh/triangle_overlap.hpp"

#include <algorithm>

namespace frontlux::sim {

TriangleOverlap::TriangleOverlap(const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d &a = corners[0], &b = corners[1], &c = corners[2];
  bounds_.extend(a).extend(b).extend(c);
  // Separating axes: two convex bodies are apart if they are apart along a normal of a face of one of them,
  // or along the cross product of an edge of each. The bounds stand for the normals of the box; here are the
  // other axes. An axis of length 0 separates nothing.
  std::size_t next = 0;
  const auto add = [&](const Eigen::Vector3d& axis) {
    const double at_a = axis.dot(a), at_b = axis.dot(b), at_c = axis.dot(c);
    projections_[next++] = {axis, std::min({at_a, at_b, at_c}), std::max({at_a, at_b, at_c})};
  };
  const std::array<Eigen::Vector3d, 3> edges{b - a, c - b, a - c};
  add(edges[0].cross(edges[1]));
  for (const Eigen::Vector3d& edge : edges)
    for (int axis = 0; axis < 3; ++axis) add(edge.cross(Eigen::Vector3d::Unit(axis)));
}

bool TriangleOverlap::touches(const Eigen::AlignedBox3d& box) const {
  if (!bounds_.intersects(box)) return false;
  const Eigen::Vector3d center = box.center(), half = box.sizes() / 2;
  return std::ranges::all_of(projections_, [&](const Projection& of_triangle) {
    const double at = of_triangle.axis.dot(center), reach = of_triangle.axis.cwiseAbs().dot(half);
    return of_triangle.low <= at + reach && of_triangle.high >= at - reach;
  });
}

}  // namespace frontlux::sim
