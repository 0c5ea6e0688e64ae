#pragma once

#include <frontlux/ray.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace frontlux::detail {

/// An axis-aligned box of voxels, both ends included, that may reach beyond the key range.
struct CellBox {
  std::array<int, 3> min{}, max{};

  [[nodiscard]] static CellBox of(const VoxelKey& key) {
    return {{key.x, key.y, key.z}, {key.x, key.y, key.z}};
  }
  /// A cube of 2^log2_edge voxels a side.
  [[nodiscard]] static CellBox of(const VoxelKey& corner, int log2_edge) {
    const int far = (1 << log2_edge) - 1;
    return {{corner.x, corner.y, corner.z}, {corner.x + far, corner.y + far, corner.z + far}};
  }

  /// Grows to hold another.
  void add(const CellBox& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      min[a] = std::min(min[a], other.min[a]);
      max[a] = std::max(max[a], other.max[a]);
    }
  }
  [[nodiscard]] CellBox grown(int by) const {
    CellBox box = *this;
    for (std::size_t a = 0; a < 3; ++a) {
      box.min[a] -= by;
      box.max[a] += by;
    }
    return box;
  }
};

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
    return static_cast<std::uint16_t>((code >> (18 + 10 * axis) & 1023U) << 6U |
                                      (code >> (9 + 3 * axis) & 7U) << 3U | (code >> (3 * axis) & 7U));
  };
  return {along(0), along(1), along(2)};
}

}  // namespace frontlux::detail
