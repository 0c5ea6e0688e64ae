#pragma once

#include <frontlux/planner/trajectory.hpp>

#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Where a path looks.
struct PathLook {
  double along;  ///< [m] from the begin of its stretch
  double yaw;    ///< [rad]
};

/// Part of a path that can be taken without a stop; the robot stops at its end.
struct PathStretch {
  std::vector<PathPiece> pieces;
  std::vector<PathLook> looks;
};

/// A path with its corners rounded by arcs: as wide as the limits can use, as the neighbouring corners leave
/// room, and as the test allows; the first also leaves room to get slow enough for it. At a corner with no
/// room for an arc a stretch ends.
/// @param speed  [m/s] of the robot at the path's begin
[[nodiscard]] std::vector<PathStretch> rounded_path(std::span<const Pose> viewpoints, double speed,
                                                    const MotionLimits& limits, const SegmentTest& is_free);

}  // namespace frontlux::planner::detail
