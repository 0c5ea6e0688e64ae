#include "robot/round_body.hpp"

#include <frontlux/sim/swept_body.hpp>

#include <algorithm>
#include <cmath>

namespace frontlux::sim {

using planner::BodyShape;

SweptBody::SweptBody(BodyShape shape, const Eigen::AlignedBox3d& start, const Eigen::Vector3d& motion)
    : shape_(shape),
      around_(start, motion),
      center_(start.center()),
      half_(start.sizes() / 2),
      motion_(motion) {}

bool SweptBody::touches(const Triangle& triangle) const {
  constexpr double kStep = 1e-3;  // [m]
  if (!around_.touches(triangle)) return false;
  if (shape_ == BodyShape::kBox) return true;
  const int steps = static_cast<int>(std::ceil(motion_.norm() / kStep));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d at = center_ + motion_ * (static_cast<double>(i) / std::max(steps, 1));
    const Triangle seen{triangle[0] - at, triangle[1] - at, triangle[2] - at};
    if (shape_ == BodyShape::kSphere ? sphere_touches(half_.x(), seen)
                                     : cylinder_touches(half_.x(), half_.z(), seen))
      return true;
  }
  return false;
}

}  // namespace frontlux::sim
