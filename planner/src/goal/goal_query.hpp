#pragma once

#include <frontlux/planner/goal_selection.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// What a rule needs to find a goal for one robot.
struct GoalQuery {
  const RayCaster& caster;
  const Lattice& lattice;
  const TravelCorridor& corridor;
  const FieldOfView& view;
  const GoalOptions& options;
  Eigen::Vector3d position;           ///< [m] of the robot's sensor
  std::span<const VoxelKey> targets;  ///< its frontiers, sorted

  /// Number of azimuth bins to render with; 0 if the robot sees all around.
  [[nodiscard]] int bins() const { return view.sees_all_around() ? 0 : options.rendering.azimuth_bins; }

  /// [m] from the robot to a cell of the corridor, as eq. 1 takes it.
  [[nodiscard]] double distance(const VoxelKey& cell) const {
    return options.distance == DistanceMeasure::kPath ? corridor.distance(cell).value()
                                                      : (lattice.exact_center(cell) - position).norm();
  }

  /// Whether a distance [m] is far enough for a goal.
  [[nodiscard]] bool far_enough(double distance) const {
    constexpr double kRounding = 1e-6;  // 0.6 m are two voxels of 0.3 m, whatever the sum says
    return distance >= options.min_distance - kRounding;
  }

  /// Whether a gain reaches `GoalOptions::min_gain`.
  [[nodiscard]] bool enough(double gain) const { return gain >= options.min_gain; }

  /// Eq. 1 with the factor of `GoalOptions::advance`.
  [[nodiscard]] double quality(double distance, double gain) const {
    const double advanced = distance < options.advance ? distance / options.advance : 1.0;
    return options.discount(distance) * advanced * gain;
  }

  /// From one voxel to another [m].
  [[nodiscard]] Eigen::Vector3d offset(const VoxelKey& from, const VoxelKey& to) const {
    return Eigen::Vector3d(to.x - from.x, to.y - from.y, to.z - from.z) * lattice.resolution();
  }

  /// For each target 1 if it is in view from the centre of a voxel, at this yaw or, without one, at any yaw,
  /// and no occupied or unknown voxel lies before it.
  [[nodiscard]] std::vector<std::uint8_t> visible_targets(const VoxelKey& from,
                                                          std::optional<double> yaw = {}) const;
};

/// `GoalRule::kClusters`, the paper's Sec. VI. Takes the clusters of targets by eq. 1 at their mean, the best
/// first, and in each cluster the targets by their distance to that mean. The goal is for the first target
/// that any cell sees: of the cells that see it, the best by eq. 1 with what is visible in the best window of
/// azimuths that holds the target.
[[nodiscard]] std::optional<RenderedCell> find_cluster_goal(const GoalQuery& query);

/// `GoalRule::kNearest`, as Yamauchi has it: to the nearest cluster of targets that touch each other. The
/// cell with the shortest path to it from which the middle of any cluster is visible, or, if no middle is,
/// any target; of equals the one with the smallest key. Its yaw looks at the nearest of these. Its gain
/// counts the targets that are visible at that yaw.
[[nodiscard]] std::optional<RenderedCell> find_nearest_goal(const GoalQuery& query);

}  // namespace frontlux::planner::detail
