#pragma once

#include <frontlux/io/point_cloud.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/scan.hpp>

#include <cmath>
#include <filesystem>
#include <limits>

/// The scan of a file, as the mapping takes it: points in the sensor's frame [m], x forward, y left, z up,
/// those beyond the sensor's range for rays that met nothing. Points and poses in an optical frame, x right,
/// y down, z forward, have to be turned first: T_sensor_optical = (0 0 1, -1 0 0, 0 -1 0).
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

/// [m] What a robot takes for free around its start without having seen it: one that drives sees no floor so
/// near. Nothing may stand there.
inline double free_radius_of(const frontlux::planner::Robot& robot) {
  return robot.travel.drives() ? 2.3 : 0.0;
}

/// Where a sensor looks [rad]: along x.
inline double yaw_of(const frontlux::io::SensorFrame& T_world_sensor) {
  return frontlux::planner::yaw_along(T_world_sensor.linear().col(0));
}
