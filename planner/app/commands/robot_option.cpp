#include "commands/robot_option.hpp"

#include "bad_input.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/robot_file.hpp>
#include <frontlux/io/spelling.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace frontlux::app {
namespace {

const std::array<std::string, 2> kOfThePaper{"ugv", "uav"};

}  // namespace

void read(std::string_view word, RobotWord& robot) {
  robot.word = word;
  std::error_code ignored;  // what is wrong with a file, reading says
  if (std::ranges::find(kOfThePaper, robot.word) != kOfThePaper.end() ||
      std::filesystem::is_regular_file(robot.word, ignored))
    return;
  const auto meant = io::meant_by(word, kOfThePaper);
  throw BadInput(quote(word) + " is none of ugv, uav, and no file" +
                 (meant ? " (did you mean " + *meant + "?)" : ""));
}

planner::RobotDescription describe(const RobotWord& robot, planner::Method method) {
  if (robot.word == kOfThePaper[0]) return planner::ugv_description();
  if (robot.word == kOfThePaper[1]) return planner::uav_description(method);
  return io::read_robot(robot.word);
}

void check(const RobotWord& word, const planner::Robot& robot, const Lattice& lattice) {
  try {
    static_cast<void>(planner::TravelCorridor(robot.travel, lattice, {}));
  } catch (const std::invalid_argument& error) {
    throw BadInput("--robot: " + word.word + ": " + error.what());
  }
}

}  // namespace frontlux::app
