#include "frontier/small_clusters.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace frontlux::planner::detail {
namespace {

// Adds to `cluster` the neighbours of `key` that it lacks, until it holds `size` voxels.
void add_neighbors(const FrontierSet& frontiers, const VoxelKey& key, std::size_t size,
                   std::vector<VoxelKey>& cluster) {
  constexpr int kLast = 0xFFFF;
  for (int x = std::max(0, key.x - 1); x <= std::min(kLast, key.x + 1); ++x)
    for (int y = std::max(0, key.y - 1); y <= std::min(kLast, key.y + 1); ++y)
      for (int z = std::max(0, key.z - 1); z <= std::min(kLast, key.z + 1); ++z) {
        const VoxelKey neighbor{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                static_cast<std::uint16_t>(z)};
        if (!frontiers.contains(neighbor)) continue;
        if (std::find(cluster.begin(), cluster.end(), neighbor) == cluster.end()) cluster.push_back(neighbor);
        if (cluster.size() >= size) return;
      }
}

}  // namespace

std::vector<VoxelKey> in_large_clusters(const FrontierSet& frontiers, std::span<const VoxelKey> some,
                                        int size) {
  const auto enough = static_cast<std::size_t>(std::max(size, 1));
  std::vector<VoxelKey> large, cluster;
  for (const VoxelKey& key : some) {
    // Growing stops as soon as it is large enough, so this looks at few voxels whatever the cluster.
    cluster.assign(1, key);
    for (std::size_t i = 0; i < cluster.size() && cluster.size() < enough; ++i)
      add_neighbors(frontiers, VoxelKey(cluster[i]), enough, cluster);
    if (cluster.size() >= enough) large.push_back(key);
  }
  return large;
}

}  // namespace frontlux::planner::detail
