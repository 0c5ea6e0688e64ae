#pragma once

#include <frontlux/sim/start_pose.hpp>

#include <Eigen/Core>

namespace frontlux::sim {

/// The voxels that a robot's body is in, those of `body_voxels` that a round body does not leave out.
class BodyVoxels {
 public:
  /// @throws std::invalid_argument as `body_voxels`
  BodyVoxels(const Lattice& lattice, const planner::Robot& robot, const planner::Pose& sensor_pose)
      : lattice_(lattice),
        box_(body_voxels(lattice, robot, sensor_pose)),
        shape_(robot.travel.planned_shape()),
        at_(sensor_pose.position),
        radius_(robot.travel.extents.x() / 2) {}

  /// The smallest box around them.
  [[nodiscard]] const KeyBox& box() const { return box_; }

  [[nodiscard]] bool contains(const VoxelKey& key) const {
    if (!box_.contains(key)) return false;
    switch (shape_) {
      case planner::BodyShape::kCylinder:
        return within_radius(key, {1.0, 1.0, 0.0});
      case planner::BodyShape::kSphere:
        return within_radius(key, {1.0, 1.0, 1.0});
      case planner::BodyShape::kBox:
        break;
    }
    return true;
  }

 private:
  // By the axes that count, 1, and do not, 0.
  [[nodiscard]] bool within_radius(const VoxelKey& key, const Eigen::Array3d& axes) const {
    constexpr double kOnFace = 1e-6;  // [voxels] as in `voxels_of`
    const Eigen::Array3d off = (lattice_.exact_center(key) - at_).array().abs() - lattice_.resolution() / 2;
    const double distance = (axes * off.max(0.0)).matrix().norm();
    return distance == 0.0 || distance < radius_ - kOnFace * lattice_.resolution();
  }

  Lattice lattice_;
  KeyBox box_;
  planner::BodyShape shape_;
  Eigen::Vector3d at_;  // of a sphere the middle, of a cylinder a point of the axis
  double radius_;       // [m]
};

}  // namespace frontlux::sim
