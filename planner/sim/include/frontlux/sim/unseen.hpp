#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/voxel_grid.hpp>

#include <span>

namespace frontlux::sim {

/// Why a team has not seen some of the observable voxels of a world: parts of all observable ones, 0 to 1.
struct Unseen {
  double in_view = 0.0;  ///< some robot could have gone where it would have seen them
  double narrow = 0.0;   ///< seen only from where no robot fits, or behind such places
  double hidden = 0.0;   ///< not seen from anywhere that a sensor could be, in any robot's field of view
};

/// By the true world: where each robot fits, or would fit if it were as small as a voxel, and what it sees
/// from there. An estimate from a few thousand of the unseen voxels, and from a cell for each 0.3 m.
/// @param map     what the team knows
/// @param robots  with the floor that they keep their height from
/// @param starts  of their sensors, one for each
/// @throws std::invalid_argument if the resolutions differ
[[nodiscard]] Unseen explain_unseen(const GroundTruth& truth, const VoxelGrid& map,
                                    std::span<const planner::Robot> robots,
                                    std::span<const planner::Pose> starts);

}  // namespace frontlux::sim
