#include "assignment/corridor_blocks.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr std::uint64_t kMaxSlots = std::uint64_t{1} << 24;
constexpr int kCubeLog2 = 4;

std::size_t block_of(const VoxelKey& key) {
  return static_cast<std::size_t>(((key.x >> 2) & 3) << 4 | ((key.y >> 2) & 3) << 2 | ((key.z >> 2) & 3));
}
int bit_of(const VoxelKey& key) { return (key.x & 3) << 4 | (key.y & 3) << 2 | (key.z & 3); }

}  // namespace

CorridorBlocks::CorridorBlocks(std::span<const VoxelKey> cells) {
  if (cells.empty()) return;
  VoxelKey min = cells[0], max = cells[0];
  for (const VoxelKey& key : cells) {
    min = {std::min(min.x, key.x), std::min(min.y, key.y), std::min(min.z, key.z)};
    max = {std::max(max.x, key.x), std::max(max.y, key.y), std::max(max.z, key.z)};
  }
  box_ = {min, max};
  low_ = {min.x >> kCubeLog2, min.y >> kCubeLog2, min.z >> kCubeLog2};
  size_ = {(max.x >> kCubeLog2) - low_[0] + 1, (max.y >> kCubeLog2) - low_[1] + 1,
           (max.z >> kCubeLog2) - low_[2] + 1};
  std::uint64_t slots = 1;
  for (const int size : size_) slots *= static_cast<std::uint64_t>(size);
  if (slots > kMaxSlots)
    throw std::invalid_argument("the cells of the corridor span " + std::to_string(slots) +
                                " cubes of 16 voxels, but at most " + std::to_string(kMaxSlots) +
                                " are possible");
  slots_.assign(slots, 0);
  for (const VoxelKey& key : cells) {
    std::uint32_t& number = slots_[slot(key.x >> kCubeLog2, key.y >> kCubeLog2, key.z >> kCubeLog2)];
    if (number == 0) {
      const auto along = [](std::uint16_t k) { return static_cast<std::uint16_t>(k & ~(kCube - 1)); };
      cubes_.push_back({{along(key.x), along(key.y), along(key.z)}, 0, {}});
      number = static_cast<std::uint32_t>(cubes_.size());
    }
    Cube& cube = cubes_[number - 1];
    const std::size_t block = block_of(key);
    cube.filled |= std::uint64_t{1} << block;
    cube.blocks[block] |= std::uint64_t{1} << bit_of(key);
  }
  std::uint64_t blocks_filled = 0;
  for (const Cube& cube : cubes_) blocks_filled += static_cast<std::uint64_t>(std::popcount(cube.filled));
  deep_ = cells.size() > 16 * blocks_filled;
}

std::size_t CorridorBlocks::slot(int x, int y, int z) const {
  return (static_cast<std::size_t>(x - low_[0]) * static_cast<std::size_t>(size_[1]) +
          static_cast<std::size_t>(y - low_[1])) *
             static_cast<std::size_t>(size_[2]) +
         static_cast<std::size_t>(z - low_[2]);
}

bool CorridorBlocks::contains(const VoxelKey& key) const {
  const std::array<int, 3> at = {key.x >> kCubeLog2, key.y >> kCubeLog2, key.z >> kCubeLog2};
  for (std::size_t a = 0; a < 3; ++a)
    if (at[a] < low_[a] || at[a] >= low_[a] + size_[a]) return false;
  const std::uint32_t number = slots_[slot(at[0], at[1], at[2])];
  return number != 0 && ((cubes_[number - 1].blocks[block_of(key)] >> bit_of(key)) & 1U) != 0;
}

void CorridorBlocks::cubes_near(const VoxelKey& voxel, const ViewRegion& view,
                                std::vector<const Cube*>& cubes) const {
  const std::array<int, 3> center = {voxel.x, voxel.y, voxel.z};
  std::array<int, 3> first{}, last{};
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::max(low_[a], (center[a] - view.reach()) >> kCubeLog2);
    last[a] = std::min(low_[a] + size_[a] - 1, (center[a] + view.reach()) >> kCubeLog2);
  }
  std::vector<std::pair<int, const Cube*>> found;
  for (int x = first[0]; x <= last[0]; ++x)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int z = first[2]; z <= last[2]; ++z) {
        const std::uint32_t number = slots_[slot(x, y, z)];
        if (number == 0) continue;
        const Cube& near = cubes_[number - 1];
        if (!view.may_contain_voxel({voxel, voxel}, cube(near.corner, kCube))) continue;
        int squared = 0;
        for (const int d : {near.corner.x + kCube / 2 - voxel.x, near.corner.y + kCube / 2 - voxel.y,
                            near.corner.z + kCube / 2 - voxel.z})
          squared += d * d;
        found.emplace_back(squared, &near);
      }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first, a.second->corner) < std::pair(b.first, b.second->corner);
  });
  for (const auto& [squared, near] : found) cubes.push_back(near);
}

BlockCells feasible_cells(const BlockCells& cells, const VoxelKey& voxel, const ViewRegion& view) {
  BlockCells feasible{cells.corner, 0};
  const int z = voxel.z - cells.corner.z;
  for (int i = 0; i < 16; ++i) {
    const std::uint64_t row = (cells.bits >> (4 * i)) & 0xF;
    if (row == 0) continue;
    const int height = view.height(cells.corner.x + (i >> 2) - voxel.x, cells.corner.y + (i & 3) - voxel.y);
    const int low = std::max(0, z - height), high = std::min(3, z + height);
    if (height < 0 || low > high) continue;
    feasible.bits |= (row & (0xFU >> (3 - high)) & (0xFU << low)) << (4 * i);
  }
  return feasible;
}

}  // namespace frontlux::planner::detail
