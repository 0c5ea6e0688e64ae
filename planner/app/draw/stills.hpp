#pragma once

#include "draw/canvas.hpp"

#include <frontlux/planner/recording.hpp>

#include <string>

namespace frontlux::app {

/// A chart of what the team and each robot had mapped at the end of each step, over steps, or of a run in
/// motion over the clock's seconds: fractions of the observable voxels; where their number is unknown, of
/// those within the bounds, or else of those mapped in the end.
[[nodiscard]] Canvas draw_coverage(const planner::Recording& recording, const std::string& name);

/// The map at a recording's end, seen obliquely from above, with the robots' paths, their starts and their
/// ends. Shown are the faces of occupied voxels that look onto free space and towards the viewer, so that
/// walls on the near side hide nothing. At most 2000 x 1600 pixels, or as many as there are voxels.
/// @throws std::invalid_argument if the map is too wide for an image
[[nodiscard]] Canvas draw_final_map(const planner::Recording& recording, const std::string& name);

}  // namespace frontlux::app
