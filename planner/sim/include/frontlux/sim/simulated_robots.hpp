#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/scan.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/sensor.hpp>
#include <frontlux/sim/surface.hpp>
#include <frontlux/sim/swept_box.hpp>
#include <frontlux/sim/world.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::sim {

/// What robots ran into, by two notions. Both let a depth of `GroundTruth::kMargin` pass, as the ground truth
/// does, so that a body may lean on what lies on a voxel's face.
struct Collisions {
  /// Voxels that the sensor came through with a surface in the collision box around them, as it is measured
  /// in whole voxels to plan with. The box is a little larger than the body, so that this says more than that
  /// a body hit something.
  std::uint64_t lattice = 0;
  /// Triangles that the body itself met: a box of exactly its extents around the sensor, on a plane from the
  /// lower face of the layer that it stands on, on all of its straight way.
  std::uint64_t physical = 0;

  Collisions& operator+=(const Collisions& more) {
    lattice += more.lattice;
    physical += more.physical;
    return *this;
  }
  friend constexpr bool operator==(const Collisions&, const Collisions&) = default;
};

/// What a robot does whose body is about to meet something.
enum class AtContact : std::uint8_t {
  kGoOn,  ///< it goes on, and the collision is counted
  kStay,  ///< its bumper holds it back: it does not set out, and that is counted
};

/// Robots that go where they are told through a world that only they know. `drive` is what
/// `planner::Exploration` asks for.
///
/// Robots neither see nor touch each other, and that is not
/// counted. Thread safety: as a standard container.
class SimulatedRobots {
 public:
  /// @param world  its mesh is copied
  /// @param truth  of the same world @pre lives as long as the robots
  /// @param seed   of the sensors' errors
  /// @throws std::invalid_argument if the mesh, a sensor or an error cannot be
  SimulatedRobots(const World& world, const GroundTruth& truth, std::vector<planner::RobotDescription> robots,
                  const RangeErrors& errors, std::uint64_t seed, AtContact at_contact = AtContact::kGoOn);

  /// Moves a robot's sensor straight from where it is to a viewpoint, and tells what it measures there;
  /// nothing if its bumper holds it back. The first time the robot appears there. The errors depend on the
  /// seed, the robot, and how many scans it took before, on nothing else.
  /// @throws std::invalid_argument if there is no such robot, or the viewpoint is not finite or outside the
  /// lattice's keys
  std::optional<planner::Scan> drive(std::size_t robot, const planner::Pose& viewpoint);

  [[nodiscard]] std::span<const planner::RobotDescription> robots() const { return robots_; }
  /// Of the last call of `drive`.
  [[nodiscard]] const Collisions& last() const { return last_; }
  /// Of one robot since it appeared. @throws std::invalid_argument if there is no such robot
  [[nodiscard]] const Collisions& of(std::size_t robot) const;
  /// Of all robots.
  [[nodiscard]] Collisions total() const;
  /// How often a bumper has held a robot back.
  [[nodiscard]] std::uint64_t held_back() const { return held_back_; }

 private:
  struct Progress {
    std::optional<planner::Pose> pose;
    std::uint64_t scans = 0;
    Collisions collisions;
  };

  void check(std::size_t robot) const;
  [[nodiscard]] Collisions collisions_between(const planner::TravelOptions& travel,
                                              const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  const GroundTruth* truth_;
  Surface surface_;
  TriangleTree solids_;
  std::vector<planner::RobotDescription> robots_;
  std::vector<Sensor> sensors_;
  std::vector<Progress> progress_;
  std::uint64_t seed_;
  AtContact at_contact_;
  std::uint64_t held_back_ = 0;
  Collisions last_;
};

}  // namespace frontlux::sim
