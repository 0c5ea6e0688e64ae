#pragma once

#include <frontlux/planner/trajectory.hpp>
#include <frontlux/python/arrays.hpp>

#include <cmath>
#include <optional>

namespace frontlux::python {

/// A dict of `pose`, `velocity` and `yaw_rate` at some times [s].
/// @param use  calls what it is given with a function that returns the `planner::MotionState` at a time
/// @throws py::value_error if a time is not finite
template <class Use>
py::dict motion_arrays(const py::object& times, const Use& use) {
  const Numbers numbers("times", times, 0);
  const std::size_t size = size_of(numbers.shape());
  for (std::size_t i = 0; i < size; ++i)
    if (!std::isfinite(numbers.number(i)))
      throw py::value_error("times: number " + std::to_string(i) + " is not finite");
  Outputs outputs(numbers.shape(), std::nullopt);
  auto* poses = outputs.memory<double>("pose", 4);
  auto* velocities = outputs.memory<double>("velocity", 3);
  auto* yaw_rates = outputs.memory<double>("yaw_rate");
  use([&](const auto& motion_at) {
    for (std::size_t i = 0; i < size; ++i) {
      const planner::MotionState state = motion_at(numbers.number(i));
      Eigen::Map<Eigen::Vector4d>(poses + 4 * i) << state.pose.position, state.pose.yaw;
      Eigen::Map<Eigen::Vector3d>(velocities + 3 * i) = state.velocity;
      yaw_rates[i] = state.yaw_rate;
    }
  });
  return outputs.arrays();
}

}  // namespace frontlux::python
