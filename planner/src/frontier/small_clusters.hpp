#pragma once

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/ray.hpp>

#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Those of some frontiers whose connected cluster, by faces, edges and corners and of all frontiers, holds
/// at least `size` voxels; in their order.
[[nodiscard]] std::vector<VoxelKey> in_large_clusters(const FrontierSet& frontiers,
                                                      std::span<const VoxelKey> some, int size);

}  // namespace frontlux::planner::detail
