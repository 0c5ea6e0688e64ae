#pragma once

#include "setup/explore_options.hpp"

#include <frontlux/planner/robot.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace frontlux::app {

/// The robots of a word like "2uav+ugv", two aerial robots and a ground robot; none if it is empty.
/// @throws BadInput
[[nodiscard]] std::vector<planner::RobotDescription> team_of(const std::string& word, planner::Method method);

/// The robots of a run: those of the word for the team, of the task and of files. Those on the ground come
/// first, since they choose first.
/// @throws BadInput
[[nodiscard]] std::vector<planner::RobotDescription> gather_robots(const ExploreOptions& options);

/// The number of the robot of this name.
/// @param giver  what names it, for messages
/// @throws BadInput
[[nodiscard]] std::size_t robot_named(const std::string& name, const std::string& giver,
                                      std::span<const planner::RobotDescription> robots);

/// When a robot takes part. If it fails and joins the others, the earlier of the two happens first: it comes
/// again, or comes late and fails then.
struct Attendance {
  std::optional<double> fails, joins;  ///< [s]
  [[nodiscard]] bool at(double time) const;
};

/// Of each robot.
/// @throws BadInput
[[nodiscard]] std::vector<Attendance> attendance_of(const ExploreOptions& options,
                                                    std::span<const planner::RobotDescription> robots);

}  // namespace frontlux::app
