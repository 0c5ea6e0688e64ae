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

/// The voxels that the box around a robot's body occupies if its sensor is here; of a robot that drives, from
/// the floor that it stands on, without the voxel of the sensor. Bodies are axis-aligned whatever the yaw,
/// and take whole voxels.
/// @throws std::invalid_argument if the pose is not finite or the body leaves the lattice's keys
[[nodiscard]] KeyBox body_voxels(const Lattice& lattice, const planner::Robot& robot,
                                 const planner::Pose& sensor_pose);

/// Why a robot cannot be here, in words; nothing if it can: all voxels of body and sensor are free, no wall
/// runs through the body, and a robot that drives has floor under each of its voxels. A free voxel can be
/// reached from the start of the ground truth by something small, perhaps not by the robot.
/// @throws std::invalid_argument if the pose is not finite
[[nodiscard]] std::optional<std::string> obstacle_at(const GroundTruth& truth, const planner::Robot& robot,
                                                     const planner::Pose& sensor_pose);

/// A point in free space from which to make the ground truth: the world's start, or the centre of the voxel
/// above it if the start lies so close to a floor that the floor is in its voxel.
/// @param faces_away whether all triangles face away from the solids, as in built-in worlds and maps. Only
/// then a start inside a solid is noticed; in another mesh the robots would explore the inside of that solid.
/// @throws std::runtime_error naming the start, if there is none, it is outside the bounds, or within a solid
[[nodiscard]] Eigen::Vector3d free_start(const World& world, double resolution, bool faces_away);

/// Where robots start: their sensors' poses, yaw 0. Robots that drive are placed first, then the others, in
/// their order; each at the free position that the fewest steps through faces of free voxels lead to, the
/// same one each time if there are several, with its margin free too if that is possible. Their bodies have
/// no voxel in common and are at least `planner::kSeparation` apart, by the straight distance. A robot that
/// drives stands on its ground, the first layer boundary at or above the floor. A robot in space keeps its
/// `min_height` above the highest of these grounds; if there are none, above the floor below `around` or the
/// lower end of the bounds. A robot that moves through nodes starts in the middle of a node that is
/// completely free, if there is one.
/// @param around [m] a free point of the ground truth
/// @return one for each robot; nothing if it fits nowhere within 15 m along each axis
[[nodiscard]] std::vector<std::optional<planner::Pose>> find_starts(const GroundTruth& truth,
                                                                    const Eigen::Vector3d& around,
                                                                    std::span<const planner::Robot> robots);

/// [m] The ground from which robots in space measure their height if no robot stands on one: the layer
/// boundary at or above the floor below a point, or the lower end of the bounds if the point is not free.
[[nodiscard]] double ground_below(const GroundTruth& truth, const Eigen::Vector3d& around);

/// The voxels that a robot knows to be free at its start without having seen them, sorted: its body, and what
/// planning keeps free around it (`BodyStencil`); around it, for a robot that drives, a disc of 2.3 m radius
/// from the ground to the sensor's height, otherwise a ball of 1 m radius; and its node if that is completely
/// free. They are free and reached from the body within this shape, so none lies beyond a wall.
/// @pre the robot can be here
[[nodiscard]] std::vector<VoxelKey> start_bubble(const GroundTruth& truth, const planner::Robot& robot,
                                                 const planner::Pose& sensor_pose);

}  // namespace frontlux::sim
