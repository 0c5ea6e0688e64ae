#pragma once

#include "draw/picture.hpp"

#include <frontlux/planner/recording.hpp>

#include <array>
#include <string>

namespace frontlux::app {

/// The names of the two pictures beside a run's recording, and the endings that they may have.
inline constexpr const char *kFinalMap = "final_map", *kCoverage = "coverage";
inline constexpr std::array kStillEndings = {".png", ".svg", ".pdf"};

/// A chart of what the team and each robot had mapped at the end of each step, over steps, or of a run in
/// motion over the clock's seconds: fractions of the observable voxels; where their number is unknown, of
/// those within the bounds, or else of those mapped in the end.
[[nodiscard]] Picture draw_coverage(const planner::Recording& recording, const std::string& name);

/// The map at a recording's end, seen obliquely from above, with the robots' paths, their starts and their
/// ends, a key of the heights and a scale. Shown are the faces of occupied voxels that look onto free space
/// and towards the viewer, so that walls on the near side hide nothing; of the paths, what they do not cover.
[[nodiscard]] Picture draw_final_map(const planner::Recording& recording, const std::string& name);

}  // namespace frontlux::app
