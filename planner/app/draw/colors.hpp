#pragma once

#include "draw/canvas.hpp"

#include <cstddef>

namespace frontlux::app {

/// The colour of a fraction from 0 (dark violet) over 0.5 (teal) to 1 (light yellow). Lightness grows evenly
/// as eyes judge it: equal steps look equal, and those who do not tell hues apart still see the order. Values
/// outside are clamped; NaN is 0.
[[nodiscard]] Color color_of(double fraction);

/// The colour of a team's robots, by number, in pictures and in the report: hues of Okabe and Ito, which the
/// colour-blind tell apart.
[[nodiscard]] Color robot_color(std::size_t robot);

}  // namespace frontlux::app
