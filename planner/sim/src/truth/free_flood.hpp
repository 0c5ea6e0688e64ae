#pragma once

#include <frontlux/key_box.hpp>
#include <frontlux/sim/ground_truth.hpp>

#include <cstddef>
#include <utility>
#include <vector>

namespace frontlux::sim {

/// Calls `visit(key)` for the free voxels of a box that can be reached from one of them within the box,
/// without crossing a wall, through voxels for which `may_enter(key)`. Voxels of fewer steps come first; the
/// order depends on nothing else. Ends when `visit` returns true.
template <class MayEnter, class Visit>
void flood_free(const GroundTruth& truth, const VoxelKey& from, const KeyBox& box, const MayEnter& may_enter,
                const Visit& visit) {
  if (!box.contains(from) || truth.at(from) != Truth::kFree || !may_enter(from)) return;
  const std::size_t size_x = box.max.x - box.min.x + std::size_t{1};
  const std::size_t size_y = box.max.y - box.min.y + std::size_t{1};
  std::vector<bool> seen(volume(box));
  const auto index = [&](const VoxelKey& key) {
    return ((key.z - box.min.z) * size_y + (key.y - box.min.y)) * size_x + (key.x - box.min.x);
  };
  std::vector<VoxelKey> front{from}, next;
  seen[index(from)] = true;
  while (!front.empty()) {
    next.clear();
    for (const VoxelKey& here : front) {
      if (visit(here)) return;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          const auto there =
              offset_key(here, axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0);
          if (!there || !box.contains(*there) || !truth.open(step < 0 ? *there : here, axis)) continue;
          if (seen[index(*there)] || !may_enter(*there)) continue;
          seen[index(*there)] = true;
          next.push_back(*there);
        }
    }
    std::swap(front, next);
  }
}

}  // namespace frontlux::sim
