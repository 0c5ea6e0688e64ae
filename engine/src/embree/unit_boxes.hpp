#pragma once

#include "embree/blocker_boxes.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <vector>

namespace frontlux::detail {

/// Appends the boxes of one unit, a cube of BoxGroup::kUnitEdge voxels, in cells of its group.
void append_unit_boxes(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& corner,
                       std::vector<PackedBox>& boxes);

}  // namespace frontlux::detail
