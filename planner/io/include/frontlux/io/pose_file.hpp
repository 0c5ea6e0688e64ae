#pragma once

#include <frontlux/export.hpp>
#include <frontlux/io/sensor_frame.hpp>
#include <frontlux/planner/pose.hpp>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

namespace frontlux::io {

/// Both readers pass over a first line of names, empty lines and lines that begin with a #. Commas separate
/// fields, which may be in double quotes; one that begins with such a quote has to be, with its quotes doubled.

/// Where the sensor was when a file was recorded.
struct RecordedPose {
  std::string file;      ///< as the pose file names it
  std::size_t line = 0;  ///< of the pose file, from 1
  /// Pose of the sensor in the world.
  SensorFrame T_world_sensor = SensorFrame::Identity();
};

/// Whether a yaw [rad] is no more than a turn; a larger one is likely in degrees.
[[nodiscard]] inline bool is_within_a_turn(double yaw) {
  return std::fabs(yaw) <= 2 * std::numbers::pi + 1e-6;
}

/// Reads a line for each scan: `file,x,y,z,qx,qy,qz,qw` or `file,x,y,z,yaw` [m, rad].
/// @throws std::runtime_error naming the file, the line, what is wrong and what to do
[[nodiscard]] FRONTLUX_EXPORT std::vector<RecordedPose> read_pose_file(const std::filesystem::path& file);

/// A pose of a list.
struct ListedPose {
  /// Of the sensor.
  planner::Pose pose;
  std::size_t line = 0;  ///< of the file, from 1
};

/// Reads a pose on each line: `x,y,z,yaw` [m, rad].
/// @throws std::runtime_error naming the file, the line, what is wrong and what to do
[[nodiscard]] FRONTLUX_EXPORT std::vector<ListedPose> read_pose_list(const std::filesystem::path& file);

}  // namespace frontlux::io
