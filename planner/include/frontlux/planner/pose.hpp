#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <filesystem>
#include <vector>

namespace frontlux::planner {

/// Where a robot or its sensor is, in the world frame. Robots stay upright: roll and pitch are 0.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  double yaw = 0.0;                                    ///< [rad] counter-clockwise from the world's x axis
};

/// A pose from a file.
struct ListedPose {
  Pose pose;
  std::size_t line = 0;  ///< of the file, from 1
};

/// Reads a table with commas, a pose on each line: `x,y,z,yaw` in metres and radians. A first line of names,
/// empty lines and lines that begin with # are passed over.
/// @throws std::runtime_error naming the file, the line, what is wrong and what to do
[[nodiscard]] std::vector<ListedPose> read_pose_list(const std::filesystem::path& file);

}  // namespace frontlux::planner
