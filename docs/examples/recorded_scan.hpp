#pragma once

#include <frontlux/io/point_cloud.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/scan.hpp>

#include <cmath>
#include <filesystem>
#include <limits>

/// The scan of a file, as the mapping takes it: points in the sensor's frame [m], those beyond the sensor's
/// range for rays that met nothing.
inline frontlux::planner::Scan scan_of(const frontlux::io::RecordedPose& recorded,
                                       const std::filesystem::path& folder, double max_range) {
  frontlux::planner::Scan scan;
  scan.origin = recorded.T_world_sensor.translation().cast<float>();
  scan.max_range = max_range;
  for (const Eigen::Vector3f& point : frontlux::io::read_point_cloud(folder / recorded.file)) {
    const Eigen::Vector3d ray = recorded.T_world_sensor.linear() * point.cast<double>();
    const double range = ray.norm();
    if (!std::isfinite(range) || range == 0.0) continue;  // not measured
    scan.directions.push_back((ray / range).cast<float>());
    scan.ranges.push_back(range <= max_range ? static_cast<float>(range)
                                             : std::numeric_limits<float>::infinity());
  }
  return scan;
}

/// Which way a sensor looks [rad].
inline double yaw_of(const frontlux::io::SensorFrame& T_world_sensor) {
  const Eigen::Vector3d forward = T_world_sensor.linear().col(0);
  return std::atan2(forward.y(), forward.x());
}
