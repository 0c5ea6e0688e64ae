#pragma once

#include <frontlux/planner/pose.hpp>

#include <span>
#include <vector>

namespace frontlux::planner {

/// How far a robot may turn from each viewpoint to the next [rad]; infinite: no limit.
class YawLimits {
 public:
  static constexpr double kTolerance = 1e-9;  ///< [rad]

  /// @param max_rate [rad/m]
  YawLimits(std::span<const Pose> viewpoints, double max_rate);

  /// From viewpoint `i` to the next [rad].
  [[nodiscard]] double step(std::size_t i) const { return steps_[i]; }

  [[nodiscard]] bool limited() const { return limited_; }

  [[nodiscard]] bool allows(std::size_t i, double yaw, double next) const;
  [[nodiscard]] bool allows(std::span<const double> yaws) const;

  /// Turns from the first yaw to the last by the smaller angle, by the same fraction of each limit. It keeps
  /// the limits if any yaws do.
  [[nodiscard]] std::vector<double> even_turn(double first, double last) const;

 private:
  std::vector<double> steps_;
  bool limited_ = false;
};

}  // namespace frontlux::planner
