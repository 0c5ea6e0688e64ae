#pragma once

#include <frontlux/planner/trajectory.hpp>

#include <limits>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Where a trajectory leads between two times [s]: of poses close to each other, the fewest between which it
/// is about straight.
[[nodiscard]] std::vector<Pose> poses_along(const Trajectory& trajectory, double from, double until);

/// The path of a robot, by its scans and, between scans that are far apart since others have been lost, by
/// the trajectories that it has followed.
class DrivenPath {
 public:
  /// The robot has followed a trajectory, from when it was told last or from the trajectory's begin on.
  /// @param until  [s]
  void follow(const Trajectory& trajectory, double until);

  /// The path from the first to the last of some poses at which the robot took scans. What it has driven
  /// before the last one is forgotten.
  /// @param far_apart  [m] farther apart from each other, two of them are joined by what lies between
  [[nodiscard]] std::vector<Pose> through(std::span<const Pose> scanned, double far_apart);

 private:
  std::vector<Pose> driven_;
  double until_ = -std::numeric_limits<double>::infinity();  // [s]
};

}  // namespace frontlux::planner::detail
