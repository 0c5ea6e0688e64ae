#pragma once

#include <frontlux/voxel_grid.hpp>

#include <span>

namespace frontlux {

/// What is new in a map. Everything that is kept up to date with a map takes this one account.
struct MapChange {
  const VoxelGrid& grid;  ///< the map as it is now
  std::span<const VoxelKey> keys =
      {};  ///< every voxel whose state is not what it was before, sorted; more do no harm
};

}  // namespace frontlux
