#include <frontlux/planner/motion_limits.hpp>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {

void MotionLimits::check() const {
  constexpr double kLeast = 1e-3;  // in SI units: slower, a path takes days
  for (const auto& [name, value] :
       {std::pair{"speed", speed}, {"acceleration", acceleration}, {"yaw_rate", yaw_rate}})
    if (!(std::isfinite(value) && value >= kLeast))
      throw std::invalid_argument("motion limits: " + std::string(name) + " is " + std::to_string(value) +
                                  ", but has to be finite and at least " + std::to_string(kLeast));
}

}  // namespace frontlux::planner
