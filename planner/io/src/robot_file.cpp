#include "members.hpp"
#include "robot_members.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/robot_file.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::io {

void check_rays(const planner::RobotDescription& robot) {
  constexpr double kRayBytes = 110.0, kGigabyte = 1e9;  // measured: rays, hits and ranges of a scan
  const double columns = static_cast<double>(robot.columns), rows = static_cast<double>(robot.rows),
               rays = columns * rows;
  const std::string sensor =
      "columns and rows are " + decimals_of(columns) + " and " + decimals_of(rows) + ": ";
  if (rays > static_cast<double>(kMostRays))
    throw std::runtime_error(sensor + "a scan would take about " +
                             decimals_of(std::ceil(rays * kRayBytes / kGigabyte)) +
                             " GB of memory; give at most " + std::to_string(kMostRays) + " rays in all");
  if (rays * robot.rate > static_cast<double>(kMostRaysPerSecond))
    throw std::runtime_error(sensor + "with a rate_hz of " + decimals_of(robot.rate) + " they are " +
                             decimals_of(std::round(rays * robot.rate)) + " rays a second; give at most " +
                             std::to_string(kMostRaysPerSecond) + " in all");
}

planner::RobotDescription read_robot(const std::filesystem::path& file) {
  const nlohmann::json object = read_json(file, {"a robot", "docs/robots.md", 3});
  Members members(file, object);
  planner::RobotDescription robot = read_robot_members(members, RobotForm::kFile);
  members.expect_no_more();
  return robot;
}

}  // namespace frontlux::io
