#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/motion_limits.hpp>
#include <frontlux/planner/pose.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner {

/// Where a robot is at a moment, and how it moves.
struct MotionState {
  /// Of the sensor.
  Pose pose;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  double yaw_rate = 0.0;                               ///< [rad/s]
};

/// A line or a circular arc, by the length along it.
struct FRONTLUX_EXPORT PathPiece {
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();       ///< [m]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< at the begin, of length 1
  Eigen::Vector3d inwards = Eigen::Vector3d::Zero();  ///< at the begin, of length 1, towards an arc's centre
  double curvature = 0.0;                             ///< [1/m] 0: a line
  double length = 0.0;                                ///< [m]

  /// The point that lies so far along the piece [m].
  [[nodiscard]] Eigen::Vector3d position(double along) const;
  /// Unit vector of travel there.
  [[nodiscard]] Eigen::Vector3d direction_at(double along) const;
  /// What remains of it after a length.
  [[nodiscard]] PathPiece from(double along) const;
};

/// Whether a robot may go straight from one point to another [m] if it may be off the line by so much [m]
/// along each axis.
using SegmentTest = std::function<bool(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                       const Eigen::Vector3d& deviation)>;

/// A robot's position and yaw over time: along lines, and arcs in the place of corners, as fast as its limits
/// allow, until it rests at the end. Times are of the clock that the planner's user keeps [s].
///
/// Speed and acceleration stay within the limits at every moment; the yaw, which has no limit on its
/// acceleration, keeps its rate. A trajectory is a value.
class FRONTLUX_EXPORT Trajectory {
 public:
  static constexpr double kLongestPath = 1e5;  ///< [m]

  /// A robot that rests. @throws std::invalid_argument if the pose or the time is not finite
  Trajectory(const Pose& pose, double time);

  /// The fastest one through some viewpoints from a moving robot. Corners are rounded as far as the test
  /// allows, and where it does not, the robot stops. The yaws between the first and the last viewpoint are
  /// kept as far as the rate allows; the last one is always reached, if need be by turning at the end.
  /// @param start       where the robot is at `time`; its velocity has to point along `viewpoints`
  /// @param viewpoints  at least one; the first is where the robot is
  /// @return nothing if the robot is too fast to take the corners ahead of it
  /// @throws std::invalid_argument if there is no viewpoint or a number is not finite
  /// @throws std::length_error if the path is longer than `kLongestPath`, since speeds are kept every 5 cm
  [[nodiscard]] static std::optional<Trajectory> through(const MotionState& start, double time,
                                                         std::span<const Pose> viewpoints,
                                                         const MotionLimits& limits,
                                                         const SegmentTest& is_free);

  /// The robot goes on along this trajectory from a time, brakes as hard as it may, and then takes some
  /// viewpoints. Without any, or with just the place where it stops, it stays there.
  /// @param viewpoints  the first is `stop(time, limits)`
  [[nodiscard]] Trajectory after_stop(double time, std::span<const Pose> viewpoints,
                                      const MotionLimits& limits, const SegmentTest& is_free) const;

  /// Where the robot rests if it brakes from a time on.
  [[nodiscard]] Pose stop(double time, const MotionLimits& limits) const;

  [[nodiscard]] double begin() const { return nodes_.front().time; }   ///< [s]
  [[nodiscard]] double end() const { return yaws_.back().time; }       ///< [s] from here on the robot rests
  [[nodiscard]] double length() const { return nodes_.back().along; }  ///< [m]
  [[nodiscard]] Pose end_pose() const { return at(end()).pose; }       ///< where it rests
  /// Before its begin and after its end the robot rests.
  [[nodiscard]] MotionState at(double time) const;

 private:
  struct Node {
    double along, speed, time;  // [m], [m/s], [s]
  };
  struct YawNode {
    double time, yaw;  // [s], [rad] not wrapped
  };
  struct Look {
    double time, yaw;  // [s], [rad]
  };

  [[nodiscard]] bool extend(std::span<const PathPiece> pieces, double speed, const MotionLimits& limits);
  void turn_to(std::span<const Look> looks, double rate);
  void append(const Trajectory& next);
  [[nodiscard]] Trajectory braking(double time, const MotionLimits& limits) const;
  [[nodiscard]] std::vector<PathPiece> pieces_from(double along) const;
  [[nodiscard]] std::size_t piece_at(double along) const;
  [[nodiscard]] Node node_at(double time) const;
  [[nodiscard]] double time_at(double along) const;

  std::vector<PathPiece> pieces_;  // the first has no length
  std::vector<double> ends_;       // of the pieces [m]
  std::vector<Node> nodes_;        // between two of them the acceleration along the path is constant
  std::vector<YawNode> yaws_;      // between two of them the yaw rate is constant; the last is the end
};

/// [s] that a robot takes along some viewpoints if it stops at each of them.
[[nodiscard]] FRONTLUX_EXPORT double stop_and_go_time(std::span<const Pose> viewpoints,
                                                      const MotionLimits& limits);

}  // namespace frontlux::planner
