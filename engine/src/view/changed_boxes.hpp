#pragma once

#include "view/target_index.hpp"

#include <span>
#include <vector>

namespace frontlux::detail {

/// Boxes around all that changed, voxels and targets: the value of a viewpoint from which no point of them
/// may be in view is still right.
/// @param changed      every voxel that changed
/// @param whole_cubes  for values that depend on how many targets a cube of 8 voxels a side holds
[[nodiscard]] std::vector<KeyBox> changed_boxes(std::span<const VoxelKey> changed, const TargetIndex& before,
                                                const TargetIndex& now, bool whole_cubes);

}  // namespace frontlux::detail
