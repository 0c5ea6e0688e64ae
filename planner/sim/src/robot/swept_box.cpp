#include <frontlux/sim/swept_box.hpp>

#include <algorithm>
#include <numeric>

namespace frontlux::sim {

SweptBox::SweptBox(const Eigen::AlignedBox3d& start, const Eigen::Vector3d& motion)
    : center_(start.center()), half_(start.sizes() / 2), motion_(motion), bounds_(start) {
  bounds_.extend(start.min() + motion).extend(start.max() + motion);
}

bool SweptBox::apart(const Eigen::Vector3d& axis, const std::array<Eigen::Vector3d, 3>& triangle) const {
  const double reach = axis.cwiseAbs().dot(half_), moved = axis.dot(motion_);
  const double low = std::min(0.0, moved) - reach, high = std::max(0.0, moved) + reach;
  const double a = axis.dot(triangle[0]), b = axis.dot(triangle[1]), c = axis.dot(triangle[2]);
  return std::min({a, b, c}) > high || std::max({a, b, c}) < low;
}

bool SweptBox::touches(const std::array<Eigen::Vector3d, 3>& triangle) const {
  // Separating axes, as in TriangleOverlap. The swept space is convex; its edges: the box's and the motion.
  const std::array<Eigen::Vector3d, 3> at{triangle[0] - center_, triangle[1] - center_,
                                          triangle[2] - center_};
  const std::array<Eigen::Vector3d, 3> sides{at[1] - at[0], at[2] - at[1], at[0] - at[2]};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d edge = Eigen::Vector3d::Unit(axis);
    if (apart(edge, at) || apart(edge.cross(motion_), at)) return false;
    for (const Eigen::Vector3d& side : sides)
      if (apart(edge.cross(side), at)) return false;
  }
  for (const Eigen::Vector3d& side : sides)
    if (apart(motion_.cross(side), at)) return false;
  return !apart(sides[0].cross(sides[1]), at);
}

TriangleBvh::TriangleBvh(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  check(mesh);
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) grow(0, static_cast<std::uint32_t>(order_.size()));
}

// Both children get half of the triangles, so 32 levels are enough for any mesh.
std::uint32_t TriangleBvh::grow(std::uint32_t begin, std::uint32_t end) {
  constexpr std::uint32_t kLeaf = 4;
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{}, begin, end, 0});
  Eigen::AlignedBox3d all, middles;
  const auto middle = [this](std::uint32_t triangle) -> Eigen::Vector3d {
    const auto [a, b, c] = corners_of(mesh_, triangle);
    return a + b + c;
  };
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Eigen::Vector3d& corner : corners_of(mesh_, order_[i])) all.extend(corner);
    middles.extend(middle(order_[i]));
  }
  nodes_[number].bounds = all;
  if (end - begin <= kLeaf) return number;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const std::uint32_t half = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return middle(a)[axis] < middle(b)[axis]; });
  grow(begin, half);
  nodes_[number].second = grow(half, end);
  return number;
}

}  // namespace frontlux::sim
