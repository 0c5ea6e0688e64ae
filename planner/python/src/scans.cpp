#include "scans.hpp"

#include <cmath>
#include <limits>

namespace frontlux::python {
namespace {

using planner::Scan;

Eigen::Vector3d row_of(const Numbers& numbers, std::size_t i) {
  return {numbers.number(i, 0), numbers.number(i, 1), numbers.number(i, 2)};
}

// In float, as scans have it: a range that was float32 all along would lie beyond a limit that is not.
float range_within(double range, double max_range) {
  const auto rounded = static_cast<float>(range);
  return rounded > static_cast<float>(max_range) ? std::numeric_limits<float>::infinity() : rounded;
}

Scan empty_scan(const SensorPose& pose, double max_range) {
  Scan scan;
  scan.origin = pose.T_map_sensor.translation().cast<float>();
  scan.max_range = max_range;
  return scan;
}

}  // namespace

Scan scan_of(const SensorPose& pose, const py::object& directions, const py::object& ranges,
             double max_range) {
  const Numbers rays("directions", directions, 3), lengths("ranges", ranges, 0);
  const std::size_t size = size_of(common_shape({&rays, &lengths}));
  Scan scan = empty_scan(pose, max_range);
  scan.directions.reserve(size);
  scan.ranges.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    scan.directions.push_back((pose.T_map_sensor.linear() * row_of(rays, i)).cast<float>());
    scan.ranges.push_back(range_within(lengths.number(i), max_range));
  }
  planner::check(scan);
  return scan;
}

Scan scan_of(const SensorPose& pose, const py::object& points, double max_range) {
  const Numbers ends("points", points, 3);
  Scan scan = empty_scan(pose, max_range);
  for (std::size_t i = 0; i < size_of(ends.shape()); ++i) {
    const Eigen::Vector3d ray = pose.T_map_sensor.linear() * row_of(ends, i);
    const double range = ray.norm();
    if (!std::isfinite(range) || range == 0.0) continue;
    scan.directions.push_back((ray / range).cast<float>());
    scan.ranges.push_back(range_within(range, max_range));
  }
  return scan;
}

}  // namespace frontlux::python
