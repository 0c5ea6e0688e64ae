#pragma once

#include <frontlux/planner/continuous_exploration.hpp>

#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <string>
#include <vector>

/// One robot that explores around the place of its first scan: what the node does, without ROS. Clouds go in,
/// what the robot is to follow comes out. Not for several threads at a time.
class Explorer {
 public:
  struct Options {
    frontlux::planner::Robot robot;
    double resolution = 0.2;                 ///< [m] edge of a voxel
    Eigen::Vector3d reach{20.0, 20.0, 5.0};  ///< [m] what is explored around the first scan, to each side
    double free_radius = 0.0;                ///< [m] known to be free there; a robot on wheels needs some 2 m
    double latency = 0.2;                    ///< [s] from a scan until the robot follows its answer
  };
  struct Waypoint {
    double time;                   ///< [s]
    frontlux::planner::Pose pose;  ///< of the sensor, in the map's frame
  };

  /// @throws std::invalid_argument naming the option that is out of bounds
  explicit Explorer(Options options);

  /// A scan.
  /// @param time    [s] on the clock that the trajectory is to be followed by
  /// @param T_map_sensor  where the sensor was then; its frame has x forward, y left, z up
  /// @param T_map_cloud   the same of the frame that the points are in, which may be an optical one
  /// @param points  [m] beyond the sensor's range: the ray met nothing; not finite: it was not measured
  /// @return the robot's new trajectory, `rate` times a second; nothing if it keeps the one that it has. A
  ///         scan that is older than the last one goes into the map and plans nothing.
  /// @throws std::invalid_argument if the time or a pose is not finite, or a pose is outside the key range
  std::optional<std::vector<Waypoint>> insert(double time, const Eigen::Isometry3d& T_map_sensor,
                                              const Eigen::Isometry3d& T_map_cloud,
                                              std::span<const Eigen::Vector3f> points, double rate = 20.0);

  /// The robot stands where something is that its sensor does not see.
  /// @throws std::invalid_argument before the first scan
  void stopped(double time, const Eigen::Isometry3d& T_map_sensor);

  /// The robot stands somewhere else than its trajectory has it, and nothing is in its path: it plans anew
  /// from there with the next scan.
  /// @throws std::invalid_argument before the first scan
  void displaced(double time, const Eigen::Isometry3d& T_map_sensor);

  /// Why the exploration is over, in words; nothing while it goes on, or before the first scan.
  [[nodiscard]] std::optional<std::string> end() const;

  /// The map; nothing before the first scan.
  [[nodiscard]] const octomap::OcTree* tree() const;

 private:
  void begin(double time, const frontlux::planner::Pose& pose);

  Options options_;
  std::optional<frontlux::planner::ContinuousExploration> exploration_;
  double time_ = 0.0;  // [s] of the latest scan
};
