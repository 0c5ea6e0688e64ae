#pragma once

#include <frontlux/export.hpp>

#include <Eigen/Core>

#include <vector>

namespace frontlux::planner {

/// One sweep of a range sensor, in the world frame: what a robot, real or simulated, gives to the mapping.
struct Scan {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();  ///< [m] the sensor's position
  double max_range = 0.0;                            ///< [m] how far the sensor measures
  std::vector<Eigen::Vector3f> directions;           ///< of unit length
  /// [m] one for each direction, up to `max_range`. Infinity: nothing within `max_range`, so all voxels up to
  /// there are free. NaN: no measurement.
  std::vector<float> ranges;
};

/// @throws std::invalid_argument naming the value, if the sizes differ, the origin is not finite, the range
/// is not positive, a direction is not of unit length, or a range is negative or finite and beyond
/// `max_range`
FRONTLUX_EXPORT void check(const Scan& scan);

}  // namespace frontlux::planner
