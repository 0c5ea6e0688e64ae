#pragma once

#include "draw/picture.hpp"

#include <frontlux/planner/robot.hpp>

#include <vector>

namespace frontlux::app {

/// Of pictures' background, lines and text, and what stands behind.
inline constexpr Color kPaper{255, 255, 255}, kInk{20, 20, 24}, kMuted{86, 97, 112};

/// The colour of a fraction from 0 (dark violet) over 0.5 (teal) to 1 (light yellow). Lightness grows evenly
/// as eyes judge it: equal steps look equal, and those who do not tell hues apart still see the order. Values
/// outside are clamped; NaN is 0.
[[nodiscard]] Color color_of(double fraction);

/// The colours of a team's robots, as in its report: see `report::robot_colors`.
[[nodiscard]] std::vector<Color> robot_colors(const std::vector<planner::RobotDescription>& team);
/// Of frontiers, as in reports.
[[nodiscard]] Color frontier_color();

}  // namespace frontlux::app
