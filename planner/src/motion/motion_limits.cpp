#include <frontlux/planner/motion_limits.hpp>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {

void MotionLimits::check() const {
  for (const auto& [name, value] :
       {std::pair{"speed", speed}, {"acceleration", acceleration}, {"yaw_rate", yaw_rate}})
    if (!(std::isfinite(value) && value > 0.0))
      throw std::invalid_argument("motion limits: " + std::string(name) + " is " + std::to_string(value) +
                                  ", but has to be finite and positive");
}

}  // namespace frontlux::planner
