#pragma once

#include "draw/canvas.hpp"

#include <frontlux/planner/recording.hpp>

#include <string>

namespace frontlux::app {

/// A chart of what the team and each robot had mapped at the end of each step: fractions of the observable
/// voxels; where their number is unknown, of those within the bounds, or else of those mapped in the end.
[[nodiscard]] Canvas draw_coverage(const planner::Recording& recording, const std::string& name);

}  // namespace frontlux::app
