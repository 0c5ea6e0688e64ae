#include <frontlux/planner/pose.hpp>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace frontlux::planner {

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
