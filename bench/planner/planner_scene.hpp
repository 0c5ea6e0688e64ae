#pragma once

#include "rays/subject.hpp"

#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/view_quality.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace frontlux::bench {

/// A map as a team's planner meets it. The ground robot's viewpoints are free voxels 0.75 m above the lowest
/// floor, the aerial robot's every second free voxel along each axis; both evenly thinned out.
struct PlannerScene {
  const Subject& subject;
  planner::Robot ground, aerial;
  std::vector<VoxelKey> frontiers;          ///< of the map, all
  std::vector<VoxelKey> ground_cells;       ///< the largest travel corridor that was found
  std::vector<VoxelKey> aerial_cells;       ///< the same in space
  std::vector<VoxelKey> ground_viewpoints;  ///< to render
  std::vector<VoxelKey> aerial_viewpoints;  ///< to render
  VoxelGrid scanned;                        ///< the map after one more scan of the aerial robot
  std::vector<VoxelKey> scanned_frontiers;  ///< and its frontiers
  std::vector<VoxelKey> changed;            ///< voxels that the scan changed, sorted

  /// @throws std::runtime_error if the map has no frontiers or no free space
  PlannerScene(const Subject& subject, planner::Adjacency adjacency, std::size_t ground_viewpoints,
               std::size_t aerial_viewpoints);

  [[nodiscard]] std::vector<planner::FrontierAgent> agents() const;
};

/// How a robot's view quality is rendered.
[[nodiscard]] ViewQualityOptions ground_rendering(int samples);
[[nodiscard]] ViewQualityOptions aerial_rendering();

}  // namespace frontlux::bench
