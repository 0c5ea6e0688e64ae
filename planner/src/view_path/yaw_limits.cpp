#include "view_path/yaw_limits.hpp"

#include "motion/yaw.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace frontlux::planner {

YawLimits::YawLimits(std::span<const Pose> viewpoints, double max_rate) {
  for (std::size_t i = 0; i + 1 < viewpoints.size(); ++i) {
    const double length = (viewpoints[i + 1].position - viewpoints[i].position).norm();
    // Not by a product: no rate limit times no length is not a number.
    const double step = std::isfinite(max_rate) ? max_rate * length : max_rate;
    // More than half a turn is never needed, and is no limit.
    steps_.push_back(step < std::numbers::pi ? step : std::numeric_limits<double>::infinity());
    limited_ = limited_ || std::isfinite(steps_.back());
  }
}

bool YawLimits::allows(std::size_t i, double yaw, double next) const {
  return std::fabs(detail::turn(yaw, next)) <= steps_[i] + kTolerance;
}

bool YawLimits::allows(std::span<const double> yaws) const {
  for (std::size_t i = 0; i < steps_.size(); ++i)
    if (!allows(i, yaws[i], yaws[i + 1])) return false;
  return true;
}

std::vector<double> YawLimits::even_turn(double first, double last) const {
  const auto most = [](double step) { return std::min(step, std::numbers::pi); };
  const double turn = detail::turn(first, last);
  double all = 0.0, passed = 0.0;
  for (const double step : steps_) all += most(step);
  std::vector<double> yaws{first};
  for (const double step : steps_) {
    passed += most(step);
    yaws.push_back(all > 0.0 ? first + turn * (passed / all) : last);
  }
  yaws.back() = last;
  return yaws;
}

}  // namespace frontlux::planner
