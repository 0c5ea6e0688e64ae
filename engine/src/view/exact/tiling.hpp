#pragma once

#include "view/exact/window_layout.hpp"
#include "view/view_render.hpp"
#include "voxel/cell_code.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace frontlux::detail {

/// A viewpoint in order of tiles: by column of tiles, then by height, then by place in the tile.
struct Placed {
  std::uint64_t order;
  std::uint32_t place;
  std::uint32_t index;
  std::uint32_t number;  // among those that are sorted
  SectorSet sectors;     // that are stale

  /// Of tiles.
  [[nodiscard]] std::uint64_t column() const { return order >> 16U; }
  /// Of the tile in its column.
  [[nodiscard]] std::size_t level() const { return order & 0xFFFFU; }
  /// In the tile.
  [[nodiscard]] std::uint32_t row() const { return place / ViewTile::kColumns; }
};

/// Where tiles lie.
struct Tiling {
  std::array<int, 3> corner{};
  std::array<int, 2> stride{1, 1};
  static constexpr int kLevels = 32;  // of viewpoints in a column of tiles

  explicit Tiling(std::span<const StaleViewpoint> viewpoints) {
    const VoxelKey first = cell_of_code(viewpoints.front().code);
    corner = {first.x, first.y, first.z};
    std::array<int, 2> apart{};
    for (const StaleViewpoint& viewpoint : viewpoints) {
      const VoxelKey key = cell_of_code(viewpoint.code);
      apart = {std::gcd(apart[0], key.x - first.x), std::gcd(apart[1], key.y - first.y)};
      corner = {std::min<int>(corner[0], key.x), std::min<int>(corner[1], key.y),
                std::min<int>(corner[2], key.z)};
    }
    for (std::size_t a = 0; a < 2; ++a)
      while (stride[a] < ViewTile::kMaxStride && apart[a] % (2 * stride[a]) == 0) stride[a] *= 2;
  }

  [[nodiscard]] Placed place(const StaleViewpoint& viewpoint, std::uint32_t number) const {
    const VoxelKey key = cell_of_code(viewpoint.code);
    const int column = (key.x - corner[0]) / stride[0], row = (key.y - corner[1]) / stride[1];
    const int level = key.z - corner[2];
    const auto digits = [](int part) { return static_cast<std::uint64_t>(part); };
    return {digits(level / kLevels) << 48U | digits(row / ViewTile::kRows) << 32U |
                digits(column / ViewTile::kColumns) << 16U | digits(level % kLevels),
            ViewTile::place(column % ViewTile::kColumns, row % ViewTile::kRows), viewpoint.index, number,
            viewpoint.sectors};
  }

  /// Voxel of a tile's first place.
  [[nodiscard]] std::array<int, 3> first_place(const Placed& placed) const {
    const auto digits = [&](unsigned shift) { return static_cast<int>(placed.order >> shift & 0xFFFFU); };
    return {corner[0] + digits(16) * ViewTile::kColumns * stride[0],
            corner[1] + digits(32) * ViewTile::kRows * stride[1],
            corner[2] + digits(48) * kLevels + digits(0)};
  }
};

/// Where each run of equal keys begins, and the end of the last.
template <class Key>
[[nodiscard]] std::vector<std::size_t> runs(std::span<const Placed> placed, const Key& key) {
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (i == 0 || key(placed[i]) != key(placed[i - 1])) begins.push_back(i);
  begins.push_back(placed.size());
  return begins;
}

}  // namespace frontlux::detail
