#pragma once

#include <frontlux/planner/trajectory.hpp>

#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// The part of the acceleration that curves may take. With all of it a robot could not brake on a curve.
inline constexpr double kSideways = 0.95;

/// A robot's speed at a place of its path; from one to the next its acceleration along the path is constant.
struct SpeedNode {
  double along;  ///< [m]
  double speed;  ///< [m/s]
};

/// The fastest motion along some pieces that join without a corner, from a speed to rest: a backward and a
/// forward pass over the length. On arcs the acceleration's norm keeps the limit also where it is one for
/// each axis. Empty if the robot cannot get slow enough.
[[nodiscard]] std::vector<SpeedNode> speed_profile(std::span<const PathPiece> pieces, double speed,
                                                   const MotionLimits& limits);

/// [m] The shortest distance in which the robot can stop along some pieces, at most all of their length.
[[nodiscard]] double braking_distance(std::span<const PathPiece> pieces, double speed,
                                      const MotionLimits& limits);

}  // namespace frontlux::planner::detail
