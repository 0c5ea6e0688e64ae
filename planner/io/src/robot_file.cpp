#include "members.hpp"
#include "robot_members.hpp"

#include <frontlux/io/robot_file.hpp>

#include <nlohmann/json.hpp>

namespace frontlux::io {

planner::RobotDescription read_robot(const std::filesystem::path& file) {
  const nlohmann::json object = read_json(file, {"a robot", "docs/robots.md", 3});
  Members members(file, object);
  planner::RobotDescription robot = read_robot_members(members, RobotForm::kFile);
  members.expect_no_more();
  return robot;
}

}  // namespace frontlux::io
