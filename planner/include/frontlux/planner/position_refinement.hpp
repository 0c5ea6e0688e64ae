#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/path_optimizer.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner {

/// How far and how often viewpoints are moved.
struct FRONTLUX_EXPORT PositionOptions {
  int outer_iterations = 3;  ///< 1 to 1000; each finds the visible pairs anew
  int steps = 8;             ///< 1 to 1000 in each iteration: evaluations of the differentiable gain
  double max_shift = 0.6;    ///< [m] of a viewpoint from its given position
  double spacing = 1.2;      ///< [m] greatest distance between a viewpoint that moves and its neighbours
  double sharpness = 8.0;    ///< of the differentiable gain by which positions move
  PathOptimizerOptions optimizer;  ///< of the yaws, once the viewpoints have moved

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// A path whose viewpoints have moved.
struct RefinedPath {
  std::vector<Pose> viewpoints;  ///< as many as were given; the first and the last are unchanged
  PathGain before;               ///< of the path given, with the visible pairs of its positions
  PathGain after;                ///< of this path, with the visible pairs of its own positions
  int outer_iterations = 0;      ///< that were kept; 0: no viewpoint has moved or turned
  std::uint64_t rays = 0;        ///< cast in all
};

/// Moves the viewpoints between the first and the last, and turns them, so that the path sees more frontiers.
///
/// Each outer iteration climbs along the gain's gradient by position, with fixed visible pairs; then it casts
/// rays from the new positions and turns the viewpoints by `optimize_path`. It is kept if more distinct
/// frontiers are in view than before, or as many with a greater fuzzy gain; else the refinement ends with the
/// result before it. So `after.distinct` is never below `before.distinct`.
///
/// A viewpoint moves only where the segments to both of its neighbours are free (`segment_is_free`) and no
/// longer than the spacing; on a plane its height stays. Segments between viewpoints that stay are not
/// tested. Deterministic. Thread safety: as `optimize_path`.
/// @param viewpoints  with yaws, all of which count for `before`
/// @param grid        of the caster, the corridor and the keys of the frontiers
/// @param corridor    of voxels, not of nodes
/// @throws std::invalid_argument if a viewpoint is not finite, or a value of the options or of the field of
/// view is out of bounds
[[nodiscard]] FRONTLUX_EXPORT RefinedPath refine_positions(std::span<const Pose> viewpoints,
                                                           std::span<const VoxelKey> frontiers,
                                                           const RayCaster& caster, const VoxelGrid& grid,
                                                           const TravelCorridor& corridor, const Robot& robot,
                                                           const PositionOptions& options = {});

}  // namespace frontlux::planner
