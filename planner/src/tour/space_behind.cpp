#include "tour/space_behind.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

bool lead_to_space(const VoxelGrid& grid, const KeyBox& bounds, std::span<const VoxelKey> frontiers, int half,
                   int steps) {
  constexpr std::array<std::array<int, 3>, 6> kFaces = {
      {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
  const auto is_unknown = [&](const VoxelKey& key) {
    return bounds.contains(key) && grid.at(key) == Occupancy::kUnknown;
  };
  const auto is_behind = [&](const VoxelKey& key) {
    return is_unknown(key) && !std::ranges::binary_search(frontiers, key);
  };
  const auto is_middle = [&](const VoxelKey& key) { return all_of(grown({key, key}, half), is_behind); };
  std::set<VoxelKey> reached(frontiers.begin(), frontiers.end());
  std::vector<VoxelKey> last(frontiers.begin(), frontiers.end()), next;
  for (int step = 0; step < steps; ++step) {
    for (const VoxelKey& key : last)
      for (const auto& [dx, dy, dz] : kFaces) {
        const auto beside = offset_key(key, dx, dy, dz);
        if (!beside || !is_unknown(*beside) || !reached.insert(*beside).second) continue;
        if (is_middle(*beside)) return true;
        next.push_back(*beside);
      }
    last = std::exchange(next, {});
  }
  return false;
}

}  // namespace frontlux::planner::detail
