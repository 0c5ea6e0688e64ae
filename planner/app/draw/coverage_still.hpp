#pragma once

#include "draw/canvas.hpp"

#include <frontlux/planner/recording.hpp>

#include <string>

namespace frontlux::app {

/// A chart of what the team knew at the end of each step, and each robot's part: shares of the observable
/// voxels, or where their number is unknown, of those within the bounds, or else of those known in the end.
[[nodiscard]] Canvas draw_coverage(const planner::Recording& recording, const std::string& name);

}  // namespace frontlux::app
