#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace frontlux::planner {

/// A scan as it was recorded: end points of rays in the sensor's frame, and where the sensor was.
struct RecordedScan {
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector3f> points;  ///< [m] those that are not finite tell nothing
};

/// The end points in the world frame [m], computed in double.
[[nodiscard]] std::vector<Eigen::Vector3f> points_in_world(const RecordedScan& scan);

/// Reads all scans of an OctoMap scan graph, the binary kind, usually named `.graph`. The whole file is
/// checked; edges are read and left out.
/// @throws std::runtime_error naming the file, what is wrong, the byte where it was found, and what to do
[[nodiscard]] std::vector<RecordedScan> read_scan_graph(const std::filesystem::path& file);

/// Reads the points of a PCD file (ascii or binary) or a PLY file (ascii or binary_little_endian) [m], by its
/// name's ending. Fields other than x, y and z, and elements other than vertices, are left out.
/// @throws std::runtime_error naming the file, what is wrong, the line or byte where it was found, and what
/// to do
[[nodiscard]] std::vector<Eigen::Vector3f> read_point_cloud(const std::filesystem::path& file);

/// Where the sensor was when a file was recorded.
struct RecordedPose {
  std::string file;      ///< as the pose file names it
  std::size_t line = 0;  ///< of the pose file, from 1
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
};

/// Reads a table with commas, a line for each scan: `file,x,y,z,qx,qy,qz,qw` or `file,x,y,z,yaw`, in metres
/// and radians. A first line of names, empty lines and lines that begin with # are passed over.
/// @throws std::runtime_error naming the file, the line, what is wrong and what to do
[[nodiscard]] std::vector<RecordedPose> read_pose_file(const std::filesystem::path& file);

}  // namespace frontlux::planner
