#pragma once

#include "poses.hpp"

#include <frontlux/planner/scan.hpp>

namespace frontlux::python {

/// A scan of directions in the sensor's frame and of ranges [m]; ranges beyond `max_range` [m] count as
/// infinite.
/// @throws py::type_error, py::value_error naming the argument
[[nodiscard]] planner::Scan scan_of(const SensorPose& pose, const py::object& directions,
                                    const py::object& ranges, double max_range);

/// A scan of points in the sensor's frame [m]. Those beyond `max_range` [m] met nothing; those that are not
/// finite, or are the sensor's own position, were not measured.
/// @throws py::type_error, py::value_error naming the argument
[[nodiscard]] planner::Scan scan_of(const SensorPose& pose, const py::object& points, double max_range);

}  // namespace frontlux::python
