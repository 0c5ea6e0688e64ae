#include <frontlux/sim/triangle_overlap.hpp>

#include <algorithm>

namespace frontlux::sim {

TriangleOverlap::TriangleOverlap(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& c) {
  bounds_.extend(a).extend(b).extend(c);
  // Two convex bodies are apart if they are along a normal of a face of one of them, or across an edge of
  // each. The normals of the box are its bounds; here are the others. Without length they separate nothing.
  std::size_t next = 0;
  const auto add = [&](const Eigen::Vector3d& axis) {
    const double at_a = axis.dot(a), at_b = axis.dot(b), at_c = axis.dot(c);
    shadows_[next++] = {axis, std::min({at_a, at_b, at_c}), std::max({at_a, at_b, at_c})};
  };
  const std::array<Eigen::Vector3d, 3> edges{b - a, c - b, a - c};
  add(edges[0].cross(edges[1]));
  for (const Eigen::Vector3d& edge : edges)
    for (int axis = 0; axis < 3; ++axis) add(edge.cross(Eigen::Vector3d::Unit(axis)));
}

bool TriangleOverlap::touches(const Eigen::AlignedBox3d& box) const {
  if (!bounds_.intersects(box)) return false;
  const Eigen::Vector3d center = box.center(), half = box.sizes() / 2;
  return std::ranges::all_of(shadows_, [&](const Shadow& shadow) {
    const double at = shadow.axis.dot(center), reach = shadow.axis.cwiseAbs().dot(half);
    return shadow.low <= at + reach && shadow.high >= at - reach;
  });
}

}  // namespace frontlux::sim
