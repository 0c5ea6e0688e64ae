#include "robot_members.hpp"

#include <frontlux/io/robot_file.hpp>

namespace frontlux::io {

planner::RobotDescription read_robot(const std::filesystem::path& file) {
  return read_robot_file(file, RobotForm::kFile);
}

}  // namespace frontlux::io
