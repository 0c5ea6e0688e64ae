#pragma once

#include "view_path/yaw_limits.hpp"

#include <frontlux/planner/information_gain.hpp>
#include <frontlux/planner/path_optimizer.hpp>

#include <span>
#include <vector>

namespace frontlux::planner {

/// Where an ascent ended.
struct Ascent {
  std::vector<double> yaws;  ///< [rad] those with most distinct frontiers in view; of equals the last
  int evaluations = 0;
  OptimizationEnd end = OptimizationEnd::kConverged;
};

/// Climbs along the gain's gradient by the yaws between the first and the last, with Ipopt.
/// @param start            one yaw for each viewpoint [rad], within the limits
/// @param sharpness        of each stage, one after the other
/// @param max_evaluations  of the gain; what a stage does not use is left to the next
/// @pre three viewpoints or more
[[nodiscard]] Ascent ascend(const InformationGain& gain, std::span<const double> start,
                            const YawLimits& limits, std::span<const double> sharpness, int max_evaluations);

}  // namespace frontlux::planner
