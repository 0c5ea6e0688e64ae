#pragma once

#include "view/sector_set.hpp"
#include "view/target_index.hpp"

#include <frontlux/view_region.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <span>

namespace frontlux::detail {

/// A viewpoint and the sectors in which it has changes in view, visible or not.
struct Onlooker {
  std::uint64_t code = 0;  ///< `cell_code` of its voxel
  SectorSet sectors;
};

/// Takes from the sectors of onlookers those in which something hides all changes. A ray whose answer changes
/// comes to its first change through voxels that are free and have been free before; from there paths are
/// followed backwards, for all onlookers at once. Sectors are left where that would take longer than to count
/// them.
///
/// To follow each ray would take as long as to count. So all paths are followed that step as the rays of some
/// direction in the sector do: along each axis always the same way, and along the axis that they advance more
/// on, x or y, as many times between two steps along the other one. Some are no rays, so that a sector may
/// stay although its changes are hidden.
/// @param grid     as it is now
/// @param changed  every voxel that changed
/// @param bins     of azimuth, at least 1
void leave_out_hidden(const VoxelGrid& grid, std::span<const VoxelKey> changed, const TargetIndex& before,
                      const TargetIndex& now, const ViewRegion& view, int bins,
                      std::span<Onlooker> onlookers);

}  // namespace frontlux::detail
