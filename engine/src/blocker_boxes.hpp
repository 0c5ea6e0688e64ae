#pragma once

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <vector>

namespace frontlux::detail {

/// Boxes that contain nothing but blockers and together cover every blocker that a ray from free space can
/// meet first: the shell, which is every blocker with a face neighbour that does not block.
///
/// Boxes may overlap, and each keeps inside its unit, so that a change makes only the units at and beside it
/// stale. A unit is a cube of kUnitEdge voxels, or a whole node of the grid's storage (64 voxels a side or
/// more) in which every voxel blocks.
///
/// A box is entered where a blocker is entered. So the box that a ray enters first gives the first blocker.
inline constexpr int kUnitEdge = 16;

/// The boxes of a grid, in order of storage. @param unknown whether unknown voxels are blockers
std::vector<KeyBox> make_blocker_boxes(const VoxelGrid& grid, UnknownPolicy unknown);

}  // namespace frontlux::detail
