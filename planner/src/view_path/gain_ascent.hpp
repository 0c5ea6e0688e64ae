#pragma once

#include "view_path/yaw_limits.hpp"

#include <frontlux/planner/information_gain.hpp>
#include <frontlux/planner/path_optimizer.hpp>

#include <span>
#include <vector>

namespace frontlux::planner {

/// Where an ascent ended.
struct Ascent {
  std::vector<double>
      yaws;  ///< [rad] of those met, the ones with most distinct frontiers; the later of equals
  int evaluations = 0;
  PathEnd end = PathEnd::kConverged;
};

/// Climbs along the gain's gradient by the yaws between the first and the last, with Ipopt.
/// @param viewpoints  for their positions, by which the gain is differentiated automatically
/// @param start  one yaw for each viewpoint [rad], within the limits
/// @param max_evaluations  of the gain; a stage cut short leaves the rest to the next
/// @pre three viewpoints or more
[[nodiscard]] Ascent ascend(const InformationGain& gain, std::span<const Pose> viewpoints,
                            std::span<const double> start, const YawLimits& limits,
                            const PathOptimizerOptions& options, int max_evaluations);

}  // namespace frontlux::planner
