#pragma once

#include <frontlux/planner/trajectory.hpp>

#include <Eigen/Geometry>

#include <limits>
#include <optional>

namespace frontlux::planner::detail {

/// [m] How far two boxes are apart along the axis on which they are farthest apart; negative if they overlap.
[[nodiscard]] double gap_between(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b);

/// The sensor positions of one robot at which its body is nearer than a gap to another robot's [m].
[[nodiscard]] Eigen::AlignedBox3d positions_too_near(const Eigen::AlignedBox3d& body,
                                                     const Eigen::AlignedBox3d& other,
                                                     const Eigen::Vector3d& other_at, double gap);

/// Where a robot is at a time [s]: its trajectory, and the one that takes its place later.
struct RobotMotion {
  Trajectory now;
  std::optional<Trajectory> next = std::nullopt;

  [[nodiscard]] MotionState at(double time) const {
    return next && time >= next->begin() ? next->at(time) : now.at(time);
  }
  [[nodiscard]] const Trajectory& last() const { return next ? *next : now; }
  /// [s] from when on it does not move; before all times if it does not move at all
  [[nodiscard]] double rests_from() const {
    const auto moves = [](const Trajectory& trajectory) { return trajectory.end() > trajectory.begin(); };
    if (moves(last())) return last().end();
    return next && moves(now) ? next->begin() : -std::numeric_limits<double>::infinity();
  }
};

/// Whether a robot on its trajectory keeps a gap [m] to another, to a millimetre if they move at up to 20 m/s
/// together, from a time [s] on and for all time to come. Robots that are nearer to each other already may
/// not come nearer yet.
/// @param speeds  [m/s] of both robots along an axis, at most and together
[[nodiscard]] bool keeps_apart(const Trajectory& trajectory, double from, const Eigen::AlignedBox3d& body,
                               const RobotMotion& other, const Eigen::AlignedBox3d& other_body, double gap,
                               double speeds);

}  // namespace frontlux::planner::detail
