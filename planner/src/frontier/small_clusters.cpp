#include "frontier/small_clusters.hpp"

#include <algorithm>
#include <cstddef>

namespace frontlux::planner::detail {
namespace {

// Adds to `cluster` the neighbours of `key` that it lacks, until it holds `size` voxels.
void add_neighbors(const FrontierSet& frontiers, const VoxelKey& key, std::size_t size,
                   std::vector<VoxelKey>& cluster) {
  static_cast<void>(all_of(grown({key, key}, 1), [&](const VoxelKey& neighbor) {
    if (frontiers.contains(neighbor) && std::find(cluster.begin(), cluster.end(), neighbor) == cluster.end())
      cluster.push_back(neighbor);
    return cluster.size() < size;
  }));
}

}  // namespace

std::vector<VoxelKey> in_large_clusters(const FrontierSet& frontiers, std::span<const VoxelKey> some,
                                        int size) {
  const auto enough = static_cast<std::size_t>(std::max(size, 1));
  std::vector<VoxelKey> large, cluster;
  for (const VoxelKey& key : some) {
    // The search stops when the cluster is large enough, so it visits few voxels of a large cluster.
    cluster.assign(1, key);
    for (std::size_t i = 0; i < cluster.size() && cluster.size() < enough; ++i)
      add_neighbors(frontiers, VoxelKey(cluster[i]), enough, cluster);
    if (cluster.size() >= enough) large.push_back(key);
  }
  return large;
}

}  // namespace frontlux::planner::detail
