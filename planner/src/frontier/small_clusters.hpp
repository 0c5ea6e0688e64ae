#pragma once

#include <frontlux/frontier_set.hpp>
#include <frontlux/ray.hpp>

#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Those of some frontiers that are in a cluster of at least `size` voxels, in their order. A cluster is what
/// faces, edges and corners connect of all frontiers.
[[nodiscard]] std::vector<VoxelKey> in_large_clusters(const FrontierSet& frontiers,
                                                      std::span<const VoxelKey> some, int size);

}  // namespace frontlux::planner::detail
