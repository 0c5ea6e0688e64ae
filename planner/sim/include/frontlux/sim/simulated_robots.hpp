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
#include <vector>

namespace frontlux::sim {

/// What a robot does if its body would meet something.
enum class AtContact : std::uint8_t {
  kGoOn,  ///< it moves, and the contact is counted
  kStay,  ///< its bumper stops it: it does not move
};

/// Robots that move and sense in a simulated world. `drive` is the `planner::Drive` of an exploration.
///
/// Robots neither see nor touch each other, and contacts between them are not counted. Thread safety: as a
/// standard container.
class SimulatedRobots {
 public:
  /// @param world  its mesh is copied
  /// @param truth  of the same world @pre lives as long as the robots
  /// @param seed   of the sensors' errors
  /// @throws std::invalid_argument if the mesh, a sensor or an error is not valid
  SimulatedRobots(const World& world, const GroundTruth& truth, std::vector<planner::RobotDescription> robots,
                  const RangeErrors& errors, std::uint64_t seed, AtContact at_contact = AtContact::kGoOn);

  /// Moves a robot's sensor straight from where it is to a viewpoint; the first time the robot appears there.
  /// The errors of its scan depend on the seed, the robot and the number of its scans before, and on nothing
  /// else.
  /// @return the scan from there; nothing if its bumper stopped it
  /// @throws std::invalid_argument if there is no such robot, or a viewpoint is not finite or beyond the keys
  std::optional<planner::Scan> drive(std::size_t robot, const planner::Pose& viewpoint);

  /// Of all robots since they appeared: triangles that a body met on its straight motions: its shape, of
  /// exactly its extents around the sensor, for a robot that drives from the lower face of the layer that it
  /// stands on. A depth of `GroundTruth::kMargin` does not count, so a body may touch a surface that lies on
  /// a voxel's face.
  [[nodiscard]] std::uint64_t contacts() const { return contacts_; }

 private:
  struct Progress {
    std::optional<planner::Pose> pose;
    std::uint64_t scans = 0;
  };

  [[nodiscard]] std::uint64_t contacts_between(const planner::TravelOptions& travel,
                                               const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  const GroundTruth* truth_;
  Surface surface_;
  TriangleBvh solids_;
  std::vector<planner::RobotDescription> robots_;
  std::vector<Sensor> sensors_;
  std::vector<Progress> progress_;
  std::uint64_t seed_;
  AtContact at_contact_;
  std::uint64_t contacts_ = 0;
};

}  // namespace frontlux::sim
