#pragma once

#include <frontlux/export.hpp>
#include <frontlux/voxel_grid.hpp>

#include <span>
#include <vector>

namespace frontlux {

/// What is new in a map. Everything that is kept up to date with a map takes this one account. It is a view
/// of what its maker holds, as a rule until the next change: to keep it, copy the grid and the keys.
struct MapChange {
  const VoxelGrid& grid;  ///< the map as it is now
  /// Every voxel whose state is not what it was before, sorted; more do no harm.
  std::span<const VoxelKey> keys = {};
};

/// Every voxel whose state differs between two maps, sorted: the keys of a `MapChange`. Between a grid and
/// its edited copy this costs as much as the edit did.
/// @throws std::invalid_argument if the resolutions differ
/// @throws std::length_error if there are more than `kMostListedKeys`
[[nodiscard]] FRONTLUX_EXPORT std::vector<VoxelKey> changed_keys(const VoxelGrid& before,
                                                                 const VoxelGrid& after);

}  // namespace frontlux
