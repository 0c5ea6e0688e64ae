#pragma once

#include "draw/picture.hpp"

#include <frontlux/planner/goal_selection.hpp>
#include <frontlux/voxel_grid.hpp>

#include <span>
#include <string>
#include <vector>

namespace frontlux::app {

/// What a picture of view quality shows.
struct ViewScene {
  const VoxelGrid& grid;
  const planner::Robot& robot;
  planner::Pose pose;                            ///< of the robot's sensor; its layer is the background
  std::span<const planner::RenderedCell> cells;  ///< of a column the best is shown
  int cell_edge = 1;                             ///< [voxels] a cell stands for such a cube of the lattice
  std::span<const VoxelKey> frontiers;           ///< that the goal was chosen for
  const planner::Goal& goal;
  std::vector<std::string> title;  ///< lines above the picture
};

/// A map seen from above: the robot's layer in greys, view quality in colours, and robot, goal and frontiers
/// on it. At least 900 pixels wide.
/// @throws std::invalid_argument if what is to be shown is too wide for an image
[[nodiscard]] Picture draw_view(const ViewScene& scene);

}  // namespace frontlux::app
