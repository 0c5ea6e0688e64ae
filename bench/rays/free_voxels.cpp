#include "rays/free_voxels.hpp"

#include "random.hpp"

#include <algorithm>

namespace frontlux::bench {
namespace {

/// Calls `visit` for the free voxels of a plane, or of all planes: block by block, each by z, then y, then x.
template <class Visit>
void for_each_free(const VoxelGrid& grid, std::optional<std::uint16_t> plane, const Visit& visit) {
  KeyBox wanted = kAllVoxels;
  if (plane) wanted.min.z = wanted.max.z = *plane;
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    const auto part = intersection(cube(block.corner, 1 << block.log2_edge), wanted);
    if (!part || (brick == nullptr && state != Occupancy::kFree)) return;
    for_each_key(*part, [&](const VoxelKey& key) {
      if (brick == nullptr || brick->at(key) == Occupancy::kFree) visit(key);
    });
  });
}

/// Number of a cube of voxels; the cubes of a row along x have consecutive ones.
std::uint64_t cube_number(int x, int y, int z) {
  return (static_cast<std::uint64_t>(z) << 32U) | (static_cast<std::uint64_t>(y) << 16U) |
         static_cast<std::uint64_t>(x);
}

/// The layers of voxels around a box, without its edges and corners.
std::vector<KeyBox> layers_around(const KeyBox& box) {
  std::vector<KeyBox> layers;
  const KeyBox around = grown(box, 1);
  for (std::uint16_t VoxelKey::*axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
    KeyBox lower = box, upper = box;
    lower.min.*axis = lower.max.*axis = around.min.*axis;
    upper.min.*axis = upper.max.*axis = around.max.*axis;
    // At the end of the key range the layer would be one of the box.
    if (around.min.*axis != box.min.*axis) layers.push_back(lower);
    if (around.max.*axis != box.max.*axis) layers.push_back(upper);
  }
  return layers;
}

}  // namespace

std::optional<std::uint16_t> fullest_free_plane(const VoxelGrid& grid) {
  std::vector<std::uint64_t> counts(Lattice::kKeysPerAxis, 0);
  for_each_free(grid, std::nullopt, [&](const VoxelKey& key) { ++counts[key.z]; });
  const auto most = std::max_element(counts.begin(), counts.end());
  if (*most == 0) return std::nullopt;
  return static_cast<std::uint16_t>(most - counts.begin());
}

std::vector<VoxelKey> sample_free_voxels(const VoxelGrid& grid, std::size_t count,
                                         std::optional<std::uint16_t> plane, std::uint64_t stream) {
  std::uint64_t total = grid.count()[static_cast<std::size_t>(Occupancy::kFree)];
  if (plane) {
    total = 0;
    for_each_free(grid, plane, [&](const VoxelKey&) { ++total; });
  }
  const std::size_t draws = std::min<std::uint64_t>(count, total);
  std::vector<std::uint64_t> ranks(draws);
  for (std::size_t i = 0; i < draws; ++i) {
    const double fraction = (static_cast<double>(i) + uniform(stream, i)) / static_cast<double>(draws);
    ranks[i] = draws == total
                   ? i
                   : std::min(static_cast<std::uint64_t>(fraction * static_cast<double>(total)), total - 1);
  }
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
  std::vector<VoxelKey> voxels;
  voxels.reserve(ranks.size());
  std::uint64_t rank = 0;
  for_each_free(grid, plane, [&](const VoxelKey& key) {
    if (voxels.size() < ranks.size() && ranks[voxels.size()] == rank++) voxels.push_back(key);
  });
  return voxels;
}

std::vector<VoxelKey> voxels_beside_free(const VoxelGrid& grid, Occupancy state) {
  std::vector<VoxelKey> found;
  const auto add = [&](const VoxelKey& key) {
    if (grid.at(key) == state) found.push_back(key);
  };
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy block_state) {
    const KeyBox box = cube(block.corner, 1 << block.log2_edge);
    if (brick != nullptr) {
      for_each_key(box, [&](const VoxelKey& key) {
        if (brick->at(key) == Occupancy::kFree) for_each_neighbour(key, add);
      });
    } else if (block_state == Occupancy::kFree) {
      for (const KeyBox& layer : layers_around(box)) for_each_key(layer, add);
    }
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::uint64_t VoxelIndex::cube_of(const VoxelKey& key) {
  return cube_number(key.x >> kLog2Cube, key.y >> kLog2Cube, key.z >> kLog2Cube);
}

VoxelIndex::VoxelIndex(std::vector<VoxelKey> voxels) : voxels_(std::move(voxels)) {
  std::sort(voxels_.begin(), voxels_.end(), [](const VoxelKey& a, const VoxelKey& b) {
    const std::uint64_t cube_a = cube_of(a), cube_b = cube_of(b);
    return cube_a != cube_b ? cube_a < cube_b : a < b;
  });
}

std::span<const VoxelKey> VoxelIndex::row(int min_x, int max_x, int y, int z) const {
  const auto first = std::ranges::lower_bound(voxels_, cube_number(min_x, y, z), {}, cube_of);
  const auto last = std::ranges::upper_bound(first, voxels_.end(), cube_number(max_x, y, z), {}, cube_of);
  return {first, last};
}

}  // namespace frontlux::bench
