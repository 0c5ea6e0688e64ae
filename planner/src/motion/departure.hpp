#pragma once

#include <frontlux/planner/trajectory.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace frontlux::planner::detail {

/// The viewpoints of a free path from a position, which comes first; empty if there is none.
using PathFrom = std::function<std::vector<Pose>(const Pose& start)>;

/// How a robot in motion takes up a new path: the place where it leaves its old one, and the viewpoints.
struct Departure {
  bool stops = false;            ///< it brakes on its old path, and `viewpoints` begin where it rests
  std::vector<Pose> viewpoints;  ///< the first is where the robot is, or where it rests
};

/// Of the departures at a time the one that arrives first: straight on, up to twice as far as the robot
/// needs to stop, then to the goal, or after a stop. Nothing if there is no path.
[[nodiscard]] std::optional<Departure> best_departure(const Trajectory& old, double time,
                                                      const PathFrom& path_from, const MotionLimits& limits,
                                                      const SegmentTest& is_free);

/// The trajectory that takes up a new path at a time.
/// @param departure  the best one of that time; its yaws may be others
[[nodiscard]] Trajectory depart(const Trajectory& old, double time, const Departure& departure,
                                const MotionLimits& limits, const SegmentTest& is_free);

}  // namespace frontlux::planner::detail
