#include "goal/viewpoint_cells.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace frontlux::planner::detail {

std::vector<VoxelKey> viewpoint_cells(std::span<const VoxelKey> cells, int stride, const VoxelKey& robot,
                                      int surroundings) {
  if (stride <= 1 || cells.empty()) return {cells.begin(), cells.end()};
  const auto cube = [stride](const VoxelKey& key) {
    return std::array{key.x / stride, key.y / stride, key.z / stride};
  };
  std::array<int, 3> low = cube(cells[0]), high = low;
  for (const VoxelKey& key : cells) {
    const auto c = cube(key);
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], c[a]);
      high[a] = std::max(high[a], c[a]);
    }
  }
  // Cells come by x, so one slab of cubes at a time is open.
  const auto size_y = static_cast<std::size_t>(high[1] - low[1] + 1);
  const auto size_z = static_cast<std::size_t>(high[2] - low[2] + 1);
  std::vector<std::uint8_t> taken(size_y * size_z);
  int slab = low[0] - 1;
  std::vector<VoxelKey> chosen;
  for (const VoxelKey& key : cells) {
    const auto c = cube(key);
    if (c[0] != slab) {
      std::fill(taken.begin(), taken.end(), std::uint8_t{0});
      slab = c[0];
    }
    std::uint8_t& there =
        taken[static_cast<std::size_t>(c[1] - low[1]) * size_z + static_cast<std::size_t>(c[2] - low[2])];
    const bool near = std::abs(key.x - robot.x) <= surroundings &&
                      std::abs(key.y - robot.y) <= surroundings && std::abs(key.z - robot.z) <= surroundings;
    if (there == 0 || near) chosen.push_back(key);
    there = 1;
  }
  return chosen;
}

}  // namespace frontlux::planner::detail
