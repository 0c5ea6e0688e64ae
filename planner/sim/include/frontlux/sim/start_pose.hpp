#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/world.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace frontlux::sim {

/// The voxels that a robot's body takes, whose sensor is here: of one on a plane, from the floor that it
/// stands on, with the sensor's own left out. Bodies are axis-aligned whatever the yaw, and take whole
/// voxels.
/// @throws std::invalid_argument if the pose is not finite or the body leaves the lattice's keys
[[nodiscard]] KeyBox body_voxels(const Lattice& lattice, const planner::Robot& robot,
                                 const planner::Pose& sensor_pose);

/// Why a robot cannot be here, for people; nothing if it can: all voxels of body and sensor are free, no wall
/// runs through the body, and one on a plane has floor under each of its voxels. What is free can be reached
/// from the start of the ground truth, by something small.
/// @throws std::invalid_argument if the pose is not finite
[[nodiscard]] std::optional<std::string> obstacle_at(const GroundTruth& truth, const planner::Robot& robot,
                                                     const planner::Pose& sensor_pose);

/// A point in free space from which to make the ground truth: the world's start, or if that lies so near
/// above a floor that the floor is in its voxel, the centre of the voxel above. Only for surfaces that face
/// away from solids, as those of built-in worlds and of maps do, it can be told whether the start is inside a
/// solid; whoever starts in a solid of any other mesh explores its inside.
/// @param faces_away whether the surface is of that kind
/// @throws std::runtime_error naming the start, if there is none, it is outside the bounds, or within a solid
[[nodiscard]] Eigen::Vector3d free_start(const World& world, double resolution, bool faces_away);

/// Where robots start: their sensors' poses, yaw 0. Robots on a plane get a place first, then the others, in
/// their order; each at the nearest free one from a point, ties going to the lower key. The bodies have no
/// voxel in common. A robot on a plane stands on its ground, the first layer boundary at or above the floor;
/// one in space keeps its `min_height` above the highest of these grounds or, if there are none, above the
/// floor below `around` or the lower end of the bounds. A robot that moves through nodes starts in the middle
/// of a node that is free to the last voxel, if there is one.
/// @param around [m] a free point of the ground truth
/// @return one for each robot; nothing if there is no place for it within 15 m along each axis
[[nodiscard]] std::vector<std::optional<planner::Pose>> find_starts(const GroundTruth& truth,
                                                                    const Eigen::Vector3d& around,
                                                                    std::span<const planner::Robot> robots);

/// [m] The ground above which robots in space keep their height, where none stands on it: the layer boundary
/// at or above the floor below a point, or the lower end of the bounds if the point is not free.
[[nodiscard]] double ground_below(const GroundTruth& truth, const Eigen::Vector3d& around);

/// What a robot knows to be free at its start without having seen it, sorted: its body, and around it of one
/// on a plane a disc of 2.3 m radius from the ground to the sensor's height, else a ball of 1 m, and its node
/// if that is free to the last voxel. Only voxels that are free and reached from the body within this shape,
/// so nothing beyond a wall is declared free.
/// @pre the robot can be here
[[nodiscard]] std::vector<VoxelKey> start_bubble(const GroundTruth& truth, const planner::Robot& robot,
                                                 const planner::Pose& sensor_pose);

}  // namespace frontlux::sim
