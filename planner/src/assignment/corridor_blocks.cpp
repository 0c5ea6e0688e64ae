#include "assignment/corridor_blocks.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr std::uint64_t kMaxCubes = std::uint64_t{1} << 24;

// The cube of a key, by its place among all cubes.
VoxelKey cube_of(const VoxelKey& key) { return make_key(key.x >> 4, key.y >> 4, key.z >> 4); }

std::size_t block_of(const VoxelKey& key) {
  return static_cast<std::size_t>(((key.x >> 2) & 3) << 4 | ((key.y >> 2) & 3) << 2 | ((key.z >> 2) & 3));
}
int bit_of(const VoxelKey& key) { return (key.x & 3) << 4 | (key.y & 3) << 2 | (key.z & 3); }

}  // namespace

CorridorBlocks::CorridorBlocks(std::span<const VoxelKey> cells) {
  if (cells.empty()) return;
  bounds_ = bounds_of(cells);
  const KeyBox cubes{cube_of(bounds_.min), cube_of(bounds_.max)};
  if (const std::uint64_t count = size_of(cubes); count > kMaxCubes)
    throw std::invalid_argument("the cells of the corridor span " + std::to_string(count) +
                                " cubes of 16 voxels, but at most " + std::to_string(kMaxCubes) +
                                " are possible");
  places_ = BoxArray<std::uint32_t>(cubes);
  for (const VoxelKey& key : cells) {
    const VoxelKey at = cube_of(key);
    std::uint32_t& place = places_[at];
    if (place == 0) {
      cubes_.push_back({make_key(at.x * kCube, at.y * kCube, at.z * kCube), 0, {}});
      place = static_cast<std::uint32_t>(cubes_.size());
    }
    Cube& cube = cubes_[place - 1];
    const std::size_t block = block_of(key);
    cube.filled |= std::uint64_t{1} << block;
    cube.blocks[block] |= std::uint64_t{1} << bit_of(key);
  }
  std::uint64_t blocks_filled = 0;
  for (const Cube& cube : cubes_) blocks_filled += static_cast<std::uint64_t>(std::popcount(cube.filled));
  deep_ = cells.size() > 16 * blocks_filled;
}

bool CorridorBlocks::contains(const VoxelKey& key) const {
  const VoxelKey at = cube_of(key);
  if (!places_.box().contains(at)) return false;
  const std::uint32_t place = places_[at];
  return place != 0 && ((cubes_[place - 1].blocks[block_of(key)] >> bit_of(key)) & 1U) != 0;
}

std::vector<const CorridorBlocks::Cube*> CorridorBlocks::cubes_near(const VoxelKey& voxel,
                                                                    const ViewRegion& region) const {
  const KeyBox reach = grown({voxel, voxel}, region.reach());
  std::vector<std::pair<int, const Cube*>> found;  // with the squared distance
  if (const auto cubes = intersection(places_.box(), {cube_of(reach.min), cube_of(reach.max)}))
    for_each_key(*cubes, [&](const VoxelKey& at) {
      const std::uint32_t place = places_[at];
      if (place == 0) return;
      const Cube& near = cubes_[place - 1];
      if (!region.may_contain_voxel({voxel, voxel}, cube(near.corner, kCube))) return;
      int squared = 0;
      for (const int d : {near.corner.x + kCube / 2 - voxel.x, near.corner.y + kCube / 2 - voxel.y,
                          near.corner.z + kCube / 2 - voxel.z})
        squared += d * d;
      found.emplace_back(squared, &near);
    });
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first, a.second->corner) < std::pair(b.first, b.second->corner);
  });
  std::vector<const Cube*> nearest_first;
  for (const auto& [squared, near] : found) nearest_first.push_back(near);
  return nearest_first;
}

BlockCells feasible_cells(const BlockCells& cells, const VoxelKey& voxel, const ViewRegion& region) {
  BlockCells feasible{cells.corner, 0};
  const int z = voxel.z - cells.corner.z;
  for (int i = 0; i < 16; ++i) {
    const std::uint64_t row = (cells.bits >> (4 * i)) & 0xF;
    if (row == 0) continue;
    const int height = region.height(cells.corner.x + (i >> 2) - voxel.x, cells.corner.y + (i & 3) - voxel.y);
    const int low = std::max(0, z - height), high = std::min(3, z + height);
    if (height < 0 || low > high) continue;
    feasible.bits |= (row & (0xFU >> (3 - high)) & (0xFU << low)) << (4 * i);
  }
  return feasible;
}

}  // namespace frontlux::planner::detail
