#include "rays/shell.hpp"

#include <algorithm>
#include <array>

namespace frontlux::bench {
namespace {

constexpr int kLog2Cube = 4;
constexpr std::uint64_t kLastKey = Lattice::kKeysPerAxis - 1;

/// Number of a cube; the cubes of a row along x have consecutive ones.
std::uint64_t cube_number(int x, int y, int z) {
  return (static_cast<std::uint64_t>(z) << 32U) | (static_cast<std::uint64_t>(y) << 16U) |
         static_cast<std::uint64_t>(x);
}

std::uint64_t cube_of(const VoxelKey& key) {
  return cube_number(key.x >> kLog2Cube, key.y >> kLog2Cube, key.z >> kLog2Cube);
}

/// Appends the face neighbours of one free voxel that have the state.
void add_neighbours(const VoxelGrid& grid, const VoxelKey& free, Occupancy state,
                    std::vector<VoxelKey>& found) {
  for (std::uint16_t VoxelKey::*axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
    for (const int step : {-1, 1}) {
      const int k = free.*axis + step;
      if (k < 0 || k >= Lattice::kKeysPerAxis) continue;
      VoxelKey neighbour = free;
      neighbour.*axis = static_cast<std::uint16_t>(k);
      if (grid.at(neighbour) == state) found.push_back(neighbour);
    }
  }
}

void add_beside_brick(const VoxelGrid& grid, const VoxelKey& corner, const Brick& brick, Occupancy state,
                      std::vector<VoxelKey>& found) {
  for (int z = 0; z < 8; ++z) {
    for (int bit = 0; bit < 64; ++bit) {
      if (((brick.free[static_cast<std::size_t>(z)] >> bit) & 1U) == 0) continue;
      add_neighbours(
          grid,
          {static_cast<std::uint16_t>(corner.x + (bit & 7)),
           static_cast<std::uint16_t>(corner.y + (bit >> 3)), static_cast<std::uint16_t>(corner.z + z)},
          state, found);
    }
  }
}

/// Only the outermost layer of a block that is all free can have other neighbours.
void add_beside_block(const VoxelGrid& grid, const Block& block, Occupancy state,
                      std::vector<VoxelKey>& found) {
  const std::uint32_t last = (1U << block.log2_edge) - 1;
  const std::array axes{&VoxelKey::x, &VoxelKey::y, &VoxelKey::z};
  for (std::size_t a = 0; a < 3; ++a) {
    for (const bool upper : {false, true}) {
      const std::uint64_t outside =
          block.corner.*axes[a] + (upper ? std::uint64_t{last} + 1 : std::uint64_t(-1));
      if (outside > kLastKey) continue;
      VoxelKey key = block.corner;
      key.*axes[a] = static_cast<std::uint16_t>(outside);
      const auto u = axes[(a + 1) % 3];
      const auto v = axes[(a + 2) % 3];
      for (std::uint32_t i = 0; i <= last; ++i) {
        for (std::uint32_t j = 0; j <= last; ++j) {
          key.*u = static_cast<std::uint16_t>(block.corner.*u + i);
          key.*v = static_cast<std::uint16_t>(block.corner.*v + j);
          if (grid.at(key) == state) found.push_back(key);
        }
      }
    }
  }
}

}  // namespace

std::vector<VoxelKey> voxels_beside_free(const VoxelGrid& grid, Occupancy state) {
  std::vector<VoxelKey> found;
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy block_state) {
    if (brick != nullptr) {
      add_beside_brick(grid, block.corner, *brick, state, found);
    } else if (block_state == Occupancy::kFree) {
      add_beside_block(grid, block, state, found);
    }
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

VoxelIndex::VoxelIndex(std::vector<VoxelKey> voxels) : voxels_(std::move(voxels)) {
  std::sort(voxels_.begin(), voxels_.end(), [](const VoxelKey& a, const VoxelKey& b) {
    const std::uint64_t cube_a = cube_of(a), cube_b = cube_of(b);
    return cube_a != cube_b ? cube_a < cube_b : a < b;
  });
}

VoxelIndex::Cubes::Cubes(const VoxelKey& place, int radius) {
  const int center[3] = {place.x, place.y, place.z};
  for (int axis = 0; axis < 3; ++axis) {
    min[axis] = std::max(center[axis] - radius, 0) >> kLog2Cube;
    max[axis] = std::min(center[axis] + radius, Lattice::kKeysPerAxis - 1) >> kLog2Cube;
  }
}

std::span<const VoxelKey> VoxelIndex::row(int min_x, int max_x, int y, int z) const {
  const auto first =
      std::lower_bound(voxels_.begin(), voxels_.end(), cube_number(min_x, y, z),
                       [](const VoxelKey& key, std::uint64_t cube) { return cube_of(key) < cube; });
  const auto last =
      std::upper_bound(first, voxels_.end(), cube_number(max_x, y, z),
                       [](std::uint64_t cube, const VoxelKey& key) { return cube < cube_of(key); });
  return {first, last};
}

}  // namespace frontlux::bench
