#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/planner/robot.hpp>

#include <string>
#include <string_view>

namespace frontlux::app {

/// A robot of the command line: "ugv" or "uav", those of the paper, or the file that describes it.
struct RobotWord {
  std::string word;
};

/// @throws BadInput if the word is neither of them, nor a file
void read(std::string_view word, RobotWord& robot);

/// @param method  of the paper's robots
/// @throws std::runtime_error what is wrong with its file
[[nodiscard]] planner::RobotDescription describe(const RobotWord& robot,
                                                 planner::Method method = planner::Method::kDefault);

/// What a robot cannot be in voxels of this size.
/// @throws BadInput
void check(const RobotWord& word, const planner::Robot& robot, const Lattice& lattice);

}  // namespace frontlux::app
