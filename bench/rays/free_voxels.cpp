#include "rays/free_voxels.hpp"

#include "random.hpp"

#include <algorithm>
#include <bit>

namespace frontlux::bench {
namespace {

VoxelKey offset(const VoxelKey& corner, std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return {static_cast<std::uint16_t>(corner.x + x), static_cast<std::uint16_t>(corner.y + y),
          static_cast<std::uint16_t>(corner.z + z)};
}

/// Lowest plane of a block that is asked for, and how many of them.
struct Planes {
  int first = 0, count = 0;
};

Planes planes_of(const Block& block, std::optional<std::uint16_t> plane) {
  const int edge = 1 << block.log2_edge;
  if (!plane) return {0, edge};
  const int z = *plane - block.corner.z;
  return z >= 0 && z < edge ? Planes{z, 1} : Planes{};
}

std::uint64_t count_free(const Block& block, const Brick* brick, Occupancy state, Planes planes) {
  std::uint64_t count = 0;
  if (brick != nullptr) {
    for (int z = planes.first; z < planes.first + planes.count; ++z) {
      count += static_cast<std::uint64_t>(std::popcount(brick->free[static_cast<std::size_t>(z)]));
    }
  } else if (state == Occupancy::kFree) {
    count = static_cast<std::uint64_t>(planes.count) << (2 * block.log2_edge);
  }
  return count;
}

/// The free voxel number `rank` of a block.
VoxelKey select_free(const Block& block, const Brick* brick, Planes planes, std::uint64_t rank) {
  if (brick == nullptr) {
    const std::uint64_t mask = (std::uint64_t{1} << block.log2_edge) - 1;
    const std::uint64_t z = static_cast<std::uint64_t>(planes.first) + (rank >> (2 * block.log2_edge));
    return offset(block.corner, rank & mask, (rank >> block.log2_edge) & mask, z);
  }
  for (int z = planes.first;; ++z) {
    std::uint64_t word = brick->free[static_cast<std::size_t>(z)];
    const auto here = static_cast<std::uint64_t>(std::popcount(word));
    if (rank >= here) {
      rank -= here;
      continue;
    }
    for (; rank > 0; --rank) word &= word - 1;
    const auto bit = static_cast<std::uint64_t>(std::countr_zero(word));
    return offset(block.corner, bit & 7U, bit >> 3U, static_cast<std::uint64_t>(z));
  }
}

}  // namespace

std::optional<std::uint16_t> fullest_free_plane(const VoxelGrid& grid) {
  std::vector<std::uint64_t> counts(Lattice::kKeysPerAxis, 0);
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    for (int z = 0; z < 1 << block.log2_edge; ++z) {
      counts[static_cast<std::size_t>(block.corner.z + z)] += count_free(block, brick, state, {z, 1});
    }
  });
  const auto most = std::max_element(counts.begin(), counts.end());
  if (*most == 0) return std::nullopt;
  return static_cast<std::uint16_t>(most - counts.begin());
}

std::vector<VoxelKey> sample_free_voxels(const VoxelGrid& grid, std::size_t count,
                                         std::optional<std::uint16_t> plane, std::uint64_t stream) {
  std::uint64_t total = 0;
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    total += count_free(block, brick, state, planes_of(block, plane));
  });
  const std::size_t draws = std::min<std::uint64_t>(count, total);
  std::vector<std::uint64_t> ranks(draws);
  for (std::size_t i = 0; i < draws; ++i) {
    const double share = (static_cast<double>(i) + uniform(stream, i)) / static_cast<double>(draws);
    ranks[i] = draws == total
                   ? i
                   : std::min(static_cast<std::uint64_t>(share * static_cast<double>(total)), total - 1);
  }
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());

  std::vector<VoxelKey> voxels;
  voxels.reserve(ranks.size());
  std::uint64_t passed = 0;
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    const Planes planes = planes_of(block, plane);
    const std::uint64_t end = passed + count_free(block, brick, state, planes);
    while (voxels.size() < ranks.size() && ranks[voxels.size()] < end) {
      voxels.push_back(select_free(block, brick, planes, ranks[voxels.size()] - passed));
    }
    passed = end;
  });
  return voxels;
}

}  // namespace frontlux::bench
