#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/scan.hpp>
#include <frontlux/planner/trajectory.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/path_revisits.hpp>
#include <frontlux/sim/sensor.hpp>
#include <frontlux/sim/simulated_robots.hpp>
#include <frontlux/sim/surface.hpp>
#include <frontlux/sim/swept_box.hpp>
#include <frontlux/sim/world.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace frontlux::sim {

/// A body begins to touch a surface, and goes on.
struct Contact {
  double time = 0.0;         ///< [s] at the end of the motion that touched
  Eigen::AlignedBox3d body;  ///< [m] the box around the body from the begin of that motion to its end
};

/// What robots in motion did to the world and to each other.
struct MotionRecord {
  std::vector<Contact> contacts;  ///< in the order of time
  std::uint64_t held_back = 0;    ///< times that a bumper stopped it instead
  double length = 0.0;            ///< [m] travelled
  double revisited = 0.0;  ///< the part of that, 0 to 1, which led to where it had been: `PathRevisits`
  double idle = 0.0;       ///< [s] at rest, not turning
  /// [m] The least by which its body could have grown, on all sides or, if it drives, sideways, without
  /// touching a surface, where it was every 20 ms; up to a metre. A cylinder grows by it in radius and on
  /// both ends. In between it may have been nearer, by about half of its way in that time.
  double clearance = 1.0;
};

/// Errors of where robots are; none by default, and none of headings. With a drift a robot that believes to
/// follow its trajectory is beside it, by a part of the length of its path since it last knew its place, in a
/// direction that is drawn anew each time. With a tracking error it sways around its trajectory, and knows.
/// Both are horizontal if the robot drives.
struct PoseErrors {
  static constexpr double kMostTracking = 10.0;  ///< [m]
  double drift = 0.0;                            ///< of the path length, 0 to 1
  /// [s] After which it knows its place, and is on its trajectory a second later; 0: never.
  double fix_every = 0.0;
  /// [m] How far it sways at its greatest speed, in proportion when slower; at most 10.
  double tracking = 0.0;
};

/// Robots that follow trajectories in a simulated world, under a clock that the simulation keeps. Each takes
/// scans at its own rate. Robots do not see each other.
class MovingRobots {
 public:
  /// Where a robot's sensor should be at a time [s].
  using Where = std::function<planner::MotionState(std::size_t robot, double time)>;

  /// A robot's scan; the next one in time, and at equal times in the robots' order.
  struct Sensed {
    double time = 0.0;  ///< [s]
    std::size_t robot = 0;
    planner::Pose pose;  ///< of the sensor, as the robot believes
    planner::Scan scan;  ///< begins there
  };
  /// A robot whose bumper stopped it.
  struct Stopped {
    std::size_t robot = 0;
    double time = 0.0;              ///< [s] from when on it rests
    planner::Pose pose;             ///< where, as it believes
    std::vector<VoxelKey> blocked;  ///< cells that it was about to enter; sorted
  };

  /// The clock begins at 0, with the robots at their starts.
  /// @param world  its mesh is copied
  /// @param truth  of the same world @pre lives as long as the robots
  /// @param seed   of the errors
  /// @throws std::invalid_argument if the mesh, a sensor, a rate or an error is not valid
  MovingRobots(const World& world, const GroundTruth& truth, std::vector<planner::RobotDescription> robots,
               std::span<const planner::Pose> starts, const RangeErrors& errors, std::uint64_t seed,
               AtContact at_contact = AtContact::kGoOn, const PoseErrors& pose_errors = {});

  /// [s] of the next scan
  [[nodiscard]] double next_time() const;

  /// Moves all robots to a time [s], after the last one and not after the next scan. A robot that its bumper
  /// stops stays where it is until the end of the call, whatever `where` says.
  void move_until(double until, const Where& where, std::vector<Stopped>& stopped);
  /// The same to the time of the next scan, and takes it.
  Sensed advance(const Where& where, std::vector<Stopped>& stopped);

  /// Whether a robot follows `where`, as all do at first, or stays where it is: then it learns at once of
  /// what it was about to learn of. @pre it is one of them
  void set_active(std::size_t robot, bool active);

  [[nodiscard]] std::span<const MotionRecord> records() const { return records_; }
  /// Where a robot believes to be. @pre it is one of them
  [[nodiscard]] const planner::Pose& believed(std::size_t robot) const { return progress_[robot].believed; }
  /// [m] The least distance between the boxes around two bodies so far; infinite for a single robot.
  [[nodiscard]] double separation() const { return separation_; }

 private:
  struct Progress {
    planner::Pose pose, believed;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();    // of the error
    double since_fix = 0.0;                                 // [m] of path since it last knew its place
    Eigen::Vector3d known_error = Eigen::Vector3d::Zero();  // [m] which it learnt of then
    std::uint64_t fixes = 0;
    double fixed_at = 0.0;  // [s] when it has learnt of that
    std::uint64_t scans = 0;
    Eigen::Vector3d phases = Eigen::Vector3d::Zero();  // [rad] of its swaying
    bool touching = false, halted = false, active = true;
    PathRevisits path;
  };

  [[nodiscard]] Eigen::AlignedBox3d body(std::size_t robot, const Eigen::Vector3d& at) const;
  void move(std::size_t robot, const planner::MotionState& to, double time, std::vector<Stopped>& stopped);
  [[nodiscard]] Eigen::Vector3d error(std::size_t robot, double time) const;
  [[nodiscard]] planner::Pose swayed(std::size_t robot, const planner::MotionState& to, double time) const;
  void forget_known_error(Progress& progress) const;
  void draw_direction(std::size_t robot);
  void draw_phases(std::size_t robot);
  void measure_clearance(std::size_t robot);
  void measure_separation();

  const GroundTruth* truth_;
  Surface surface_;
  TriangleBvh solids_;
  std::vector<planner::RobotDescription> robots_;
  std::vector<Sensor> sensors_;
  std::vector<Progress> progress_;
  std::vector<MotionRecord> records_;
  double time_ = 0.0;
  double separation_ = std::numeric_limits<double>::infinity();
  std::uint64_t seed_;
  AtContact at_contact_;
  PoseErrors pose_errors_;
};

}  // namespace frontlux::sim
