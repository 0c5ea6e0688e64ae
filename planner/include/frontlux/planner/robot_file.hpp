#pragma once

#include <frontlux/planner/robot.hpp>

#include <cstddef>
#include <filesystem>

namespace frontlux::planner {

/// A robot with the number of rays in a scan of its sensor.
struct RobotDescription {
  Robot robot;
  std::size_t columns = 0, rows = 0;  ///< azimuths and beams of a spinning sensor, pixels of a camera
};

/// The paper's robots: 32 beams x 720 azimuths; 160 x 120 pixels.
[[nodiscard]] RobotDescription ugv_description();
[[nodiscard]] RobotDescription uav_description(Method method = Method::kDefault);

/// Reads a robot from a JSON file; docs/robots.md shows one and says what each member means.
/// @throws std::runtime_error naming the file, the member, what is wrong and what to do
[[nodiscard]] RobotDescription read_robot(const std::filesystem::path& file);

}  // namespace frontlux::planner
