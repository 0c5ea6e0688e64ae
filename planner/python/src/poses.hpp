#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/python/arrays.hpp>

#include <Eigen/Geometry>

#include <span>

namespace frontlux::python {

/// Where a sensor is when it takes a scan, and as the planner sees it: upright.
struct SensorPose {
  Eigen::Isometry3d T_map_sensor;
  planner::Pose upright;
};

/// (4,): x, y, z [m] and yaw [rad]; or (4, 4), which maps the sensor's frame into the map's.
/// @throws py::value_error naming the argument if it is neither, not finite, no rotation and translation, or
///         outside the key range
[[nodiscard]] SensorPose sensor_pose(const char* name, const py::object& object, const Lattice& lattice);

/// float64 (n, 4): x, y, z [m] and yaw [rad].
[[nodiscard]] py::array_t<double> to_array(std::span<const planner::Pose> poses);
/// float64 (4,)
[[nodiscard]] py::array_t<double> to_array(const planner::Pose& pose);

}  // namespace frontlux::python
