#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/voxel_grid.hpp>

#include <optional>
#include <span>
#include <vector>

namespace frontlux::sim {

/// What keeps one robot of a team from seeing what is `narrow`; what several of them would see may overlap.
struct KeptOut {
  /// [m] In steps of 0.05 m, the least by which its body would have to be smaller to see at least half of it:
  /// along all axes, of a robot that drives along x and y. It keeps its margin. Nothing if no body of its
  /// shape is small enough.
  std::optional<double> narrow_by;
  double in_view_then = 0.0;  ///< part of all observable voxels, of the narrow ones, that it would see so
  /// The same, if it had no minimum height and its body as it is; 0 if it drives.
  double without_min_height = 0.0;
};

/// A part of all observable voxels that is worth a word.
inline constexpr double kMuchUnseen = 0.01;

/// Why a team has not seen some of the observable voxels of a world: parts of all observable ones, 0 to 1.
struct Unseen {
  double in_view = 0.0;  ///< some robot could have gone where it would have seen them
  double narrow = 0.0;   ///< seen only from where no robot fits, or behind such places
  double hidden = 0.0;   ///< not seen from anywhere that a sensor could be, in any robot's field of view
  std::vector<KeptOut> robots;  ///< of the team, in its order; empty if `narrow` is below `kMuchUnseen`
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
