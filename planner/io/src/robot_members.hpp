#pragma once

#include "members.hpp"

#include <frontlux/planner/robot.hpp>

#include <filesystem>

namespace frontlux::io {

/// Where a robot is described. In a task its body has a kind, and its default least height is that at which
/// the body is just above the floor: a task's box limits where it flies.
enum class RobotForm { kFile, kTask };

/// Takes all members that describe a robot, but does not say that there are no others.
[[nodiscard]] planner::RobotDescription read_robot_members(Members& members, RobotForm form);

/// The robot of a file of its own.
[[nodiscard]] planner::RobotDescription read_robot_file(const std::filesystem::path& file,
                                                        RobotForm default_height);

/// All members of a robot in a task; reading them gives the same robot.
[[nodiscard]] nlohmann::ordered_json json_of(const planner::RobotDescription& robot);

}  // namespace frontlux::io
