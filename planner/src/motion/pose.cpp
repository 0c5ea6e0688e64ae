#include <frontlux/planner/pose.hpp>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace frontlux::planner {

double yaw_along(const Eigen::Vector3d& offset, double otherwise) {
  return offset.x() != 0.0 || offset.y() != 0.0 ? std::atan2(offset.y(), offset.x()) : otherwise;
}

double path_length(std::span<const Pose> viewpoints) {
  double length = 0.0;
  for (std::size_t i = 1; i < viewpoints.size(); ++i)
    length += (viewpoints[i].position - viewpoints[i - 1].position).norm();
  return length;
}

void check_finite(std::span<const Pose> viewpoints) {
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const auto& [position, yaw] = viewpoints[i];
    if (position.allFinite() && std::isfinite(yaw)) continue;
    throw std::invalid_argument("viewpoint " + std::to_string(i) + " is not finite: x " +
                                std::to_string(position.x()) + ", y " + std::to_string(position.y()) +
                                ", z " + std::to_string(position.z()) + ", yaw " + std::to_string(yaw));
  }
}

}  // namespace frontlux::planner
