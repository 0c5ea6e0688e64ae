#pragma once

#include <frontlux/brick_table.hpp>
#include <frontlux/ray.hpp>

#include <array>
#include <cstdint>

namespace frontlux::planner::detail {

using frontlux::detail::Layers;

/// The same set in the order in which an octree holds it: a word for each octant of 4 voxels a side, in it a
/// byte for each octant of 2, in it a bit for each voxel. Octants are numbered as OctoMap numbers children: x
/// counts 1, y 2, z 4.
using Octants = std::array<std::uint64_t, 8>;

[[nodiscard]] inline Octants to_octants(const Layers& layers) {
  // The four voxels of half a row lie in two octants of 2, side by side.
  const auto spread = [](std::uint64_t half_row) { return (half_row & 3U) | ((half_row & 12U) << 6); };
  Octants octants{};
  for (unsigned z = 0; z < 8; ++z)
    for (unsigned y = 0; y < 8 && (layers[z] >> (8 * y)) != 0; ++y) {
      const std::uint64_t row = (layers[z] >> (8 * y)) & 0xFF;
      const unsigned word = ((z >> 2) << 2) | ((y >> 2) << 1);
      const unsigned bit =
          8 * ((((z >> 1) & 1U) << 2) | (((y >> 1) & 1U) << 1)) + ((z & 1U) << 2) + ((y & 1U) << 1);
      octants[word] |= spread(row & 15U) << bit;
      octants[word | 1U] |= spread(row >> 4) << bit;
    }
  return octants;
}

/// Where the voxel with this number in octree order (0 to 511) lies in its brick.
[[nodiscard]] constexpr VoxelKey in_brick(unsigned number) {
  const auto along = [number](unsigned axis) {
    const unsigned n = number >> axis;
    return (n & 1U) | ((n >> 2) & 2U) | ((n >> 4) & 4U);
  };
  return make_key(along(0), along(1), along(2));
}

/// The number of a brick in octree order among all bricks of the key range: 39 bits, three for each level.
[[nodiscard]] constexpr std::uint64_t brick_number(const VoxelKey& key) {
  const auto spread = [](std::uint64_t n) {  // bit i moves to bit 3 i
    n = (n | (n << 16)) & 0x001F'0000'FF00'00FF;
    n = (n | (n << 8)) & 0x100F'00F0'0F00'F00F;
    n = (n | (n << 4)) & 0x10C3'0C30'C30C'30C3;
    n = (n | (n << 2)) & 0x1249'2492'4924'9249;
    return n;
  };
  return spread(key.x >> 3U) | (spread(key.y >> 3U) << 1) | (spread(key.z >> 3U) << 2);
}

/// Lowest voxel of the brick that holds a voxel.
[[nodiscard]] constexpr VoxelKey brick_corner(const VoxelKey& key) {
  return make_key(key.x & ~7, key.y & ~7, key.z & ~7);
}

}  // namespace frontlux::planner::detail
