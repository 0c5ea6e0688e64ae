#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/world.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::sim {

/// The ground robot, with the lidar, and the aerial robot, with the depth camera.
enum class Robot : std::uint8_t { kUgv, kUav };

/// Bodies are axis-aligned whatever the yaw, and take whole voxels. The UGV stands on its ground: the first
/// layer boundary at or above the floor.
inline constexpr double kUgvWidth = 1.0;          ///< [m] along x and y
inline constexpr double kUgvHeight = 0.7;         ///< [m]
inline constexpr double kUgvSensorHeight = 0.75;  ///< [m] above the ground
inline constexpr double kUavWidth = 0.8;          ///< [m] of its cube, with the sensor in the centre
inline constexpr double kUavClearance = 1.2;      ///< [m] lowest centre above the UGV's ground

/// The voxels that a robot's body takes, whose sensor is here; of the UGV, the one of its sensor left out.
/// @throws std::invalid_argument if the pose is not finite or the body leaves the lattice's keys
[[nodiscard]] KeyBox body_voxels(const Lattice& lattice, Robot robot, const planner::Pose& sensor_pose);

/// Why a robot cannot be here, for people; nothing if it can: all voxels of body and sensor are free, no wall
/// runs through the body, and a UGV has floor under each of its voxels. What is free can be reached from the
/// start of the ground truth, by something small.
/// @throws std::invalid_argument if the pose is not finite
[[nodiscard]] std::optional<std::string> obstacle_at(const GroundTruth& truth, Robot robot,
                                                     const planner::Pose& sensor_pose);

/// A point in free space from which to make the ground truth: the world's start, or if that lies so near
/// above a floor that the floor is in its voxel, the centre of the voxel above. Only for surfaces that face
/// away from solids, as those of built-in worlds and of maps do, it can be told whether the start is inside a
/// solid; whoever starts in a solid of any other mesh explores its inside.
/// @param faces_away whether the surface is of that kind
/// @throws std::runtime_error naming the start, if there is none, it is outside the bounds, or within a solid
[[nodiscard]] Eigen::Vector3d free_start(const World& world, double resolution, bool faces_away);

/// Where robots start: their sensors' poses, yaw 0. Searched through free space from a point, nearest way
/// first; ties go to the lower key. The bodies have no voxel in common.
/// @param around [m] a free point of the ground truth
/// @return nothing if there is no place within 15 m along each axis
[[nodiscard]] std::optional<planner::Pose> find_ugv_start(const GroundTruth& truth,
                                                          const Eigen::Vector3d& around);
/// @param ground [m] the UGV's, above which the UAV keeps its clearance; if there is none, the floor's
/// boundary below `around` or the lower end of the bounds
/// @param ugv    the UGV's pose, if there is one
[[nodiscard]] std::optional<planner::Pose> find_uav_start(const GroundTruth& truth,
                                                          const Eigen::Vector3d& around,
                                                          const std::optional<planner::Pose>& ugv);

/// What a robot knows to be free at its start without having seen it, sorted: its body, and around it of the
/// UGV a disc of 2.3 m radius from the ground to the sensor's height, of the UAV a ball of 1 m. Only voxels
/// that are free and reached from the body within this shape, so nothing beyond a wall is declared free.
/// @pre the robot can be here
[[nodiscard]] std::vector<VoxelKey> start_bubble(const GroundTruth& truth, Robot robot,
                                                 const planner::Pose& sensor_pose);

}  // namespace frontlux::sim
