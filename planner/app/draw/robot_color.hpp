#pragma once

#include "draw/canvas.hpp"

#include <cstddef>

namespace frontlux::app {

/// The colour of a team's robots, by number, in pictures and in the report: hues of Okabe and Ito, which the
/// colour-blind tell apart.
[[nodiscard]] Color robot_color(std::size_t robot);

}  // namespace frontlux::app
