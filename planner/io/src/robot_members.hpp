#pragma once

#include "members.hpp"

#include <frontlux/planner/robot.hpp>

namespace frontlux::io {

/// Where a robot is described. In a task its body has a kind.
enum class RobotForm { kFile, kTask };

/// Takes all members that describe a robot, but does not say that there are no others.
[[nodiscard]] planner::RobotDescription read_robot_members(Members& members, RobotForm form);

/// All members of a robot in a task; reading them gives the same robot.
[[nodiscard]] nlohmann::ordered_json json_of(const planner::RobotDescription& robot);

}  // namespace frontlux::io
