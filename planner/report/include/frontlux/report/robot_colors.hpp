#pragma once

#include <frontlux/planner/robot.hpp>

#include <span>
#include <string_view>
#include <vector>

namespace frontlux::report {

/// A colour on a light and on a dark background, as "#d55e00".
struct ColorPair {
  std::string_view light, dark;
};

/// The colours of a team's robots, from data/palette.json. A robot has its colour by what it is and by the
/// number at the end of its name, alone and in any team: `uav` and `uav1` the first of the cold ones for
/// aerial robots, `ugv2` the second of the warm ones for ground robots. Who comes later in a team and finds
/// its colour taken gets the next free one.
[[nodiscard]] std::vector<ColorPair> robot_colors(std::span<const planner::RobotDescription> team);

/// The colour of frontiers that are no robot's, from the same file.
[[nodiscard]] ColorPair frontier_color();

}  // namespace frontlux::report
