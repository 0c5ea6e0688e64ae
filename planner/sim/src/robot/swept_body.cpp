#include "robot/round_body.hpp"

#include <frontlux/sim/swept_body.hpp>

#include <algorithm>
#include <cmath>

namespace frontlux::sim {
namespace {

// Whether `touches(seen)` for the triangle relative to the middle of a body, somewhere along its motion.
template <class Touches>
bool touches_along(const Triangle& triangle, const Eigen::Vector3d& center, const Eigen::Vector3d& motion,
                   const Touches& touches) {
  constexpr double kStep = 1e-3;  // [m]
  const int steps = static_cast<int>(std::ceil(motion.norm() / kStep));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d at = center + motion * (static_cast<double>(i) / std::max(steps, 1));
    if (touches(Triangle{triangle[0] - at, triangle[1] - at, triangle[2] - at})) return true;
  }
  return false;
}

}  // namespace

using planner::BodyShape;

SweptBody::SweptBody(BodyShape shape, const Eigen::AlignedBox3d& start, const Eigen::Vector3d& motion)
    : shape_(shape),
      around_(start, motion),
      center_(start.center()),
      half_(start.sizes() / 2),
      motion_(motion) {}

bool SweptBody::touches(const Triangle& triangle) const {
  if (!around_.touches(triangle)) return false;
  switch (shape_) {
    case BodyShape::kCylinder:
      return touches_along(triangle, center_, motion_, [&](const Triangle& seen) {
        return cylinder_touches(half_.x(), half_.z(), seen);
      });
    case BodyShape::kSphere:
      return touches_along(triangle, center_, motion_,
                           [&](const Triangle& seen) { return sphere_touches(half_.x(), seen); });
    case BodyShape::kBox:
      break;
  }
  return true;
}

}  // namespace frontlux::sim
