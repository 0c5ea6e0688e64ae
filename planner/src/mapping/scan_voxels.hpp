#pragma once

#include "mapping/octree_order.hpp"
#include "mapping/ray_path.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/voxel_grid.hpp>

#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// What a scan says about the voxels of one brick. No voxel is in both sets.
struct BrickUpdate {
  std::uint64_t number = 0;  ///< `brick_number`
  VoxelKey corner;
  Octants misses{};
  Octants hits{};
};

/// The voxels that the rays of one scan pass and hit, each once, inside `bounds`; bricks in octree order.
/// Rays from inside the bounds are followed no further than they reach.
/// @param origin  of all rays [m]; inside the key range
/// @param rays    their `reach` is written
[[nodiscard]] std::vector<BrickUpdate> voxels_of_scan(const Lattice& lattice, const KeyBox& bounds,
                                                      const Eigen::Vector3f& origin, std::span<ScanRay> rays);

}  // namespace frontlux::planner::detail
