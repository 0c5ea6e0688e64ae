#pragma once

#include <frontlux/key_box.hpp>

#include <cstdint>

namespace frontlux::detail {

/// A number for each voxel that sorts them by cube of 64 voxels a side, then by cube of 8, then in the cube.
[[nodiscard]] constexpr std::uint64_t cell_code(const VoxelKey& key) {
  const auto digits = [&key](int shift, int bits) {
    const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
    return ((key.z >> shift & mask) << 2 * bits) | ((key.y >> shift & mask) << bits) |
           (key.x >> shift & mask);
  };
  return digits(6, 10) << 18 | digits(3, 3) << 9 | digits(0, 3);
}
constexpr int kBlockCode = 9;    ///< `cell_code` without so many bits names the cube of 8 voxels a side
constexpr int kRegionCode = 18;  ///< and the cube of 64

/// The voxel with this number.
[[nodiscard]] constexpr VoxelKey cell_of_code(std::uint64_t code) {
  const auto along = [code](int axis) {
    return static_cast<std::int64_t>((code >> (18 + 10 * axis) & 1023U) << 6U |
                                     (code >> (9 + 3 * axis) & 7U) << 3U | (code >> (3 * axis) & 7U));
  };
  return make_key(along(0), along(1), along(2));
}

/// The cube of 8 voxels a side that holds the voxel with this number.
[[nodiscard]] constexpr KeyBox cube_of_code(std::uint64_t code) {
  return cube(cell_of_code(code >> kBlockCode << kBlockCode), 8);
}

}  // namespace frontlux::detail
