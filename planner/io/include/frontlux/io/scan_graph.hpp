#pragma once

#include <frontlux/export.hpp>
#include <frontlux/io/sensor_frame.hpp>

#include <Eigen/Core>

#include <filesystem>
#include <vector>

namespace frontlux::io {

/// A scan as it was recorded: the end points of its rays in the sensor's frame, and where the sensor was.
struct RecordedScan {
  /// Pose of the sensor in the world.
  SensorFrame T_world_sensor = SensorFrame::Identity();
  std::vector<Eigen::Vector3f> points;  ///< [m] a point that is not finite is no measurement
};

/// The end points in the world frame [m], computed in double.
[[nodiscard]] FRONTLUX_EXPORT std::vector<Eigen::Vector3f> points_in_world(const RecordedScan& scan);

/// Reads all scans of an OctoMap scan graph, the binary kind, usually named `.graph`. The whole file is
/// checked; edges are read and left out.
/// @throws std::runtime_error naming the file, what is wrong, the byte where it was found, and what to do
[[nodiscard]] FRONTLUX_EXPORT std::vector<RecordedScan> read_scan_graph(const std::filesystem::path& file);

}  // namespace frontlux::io
