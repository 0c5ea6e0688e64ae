#pragma once

#include <cstddef>
#include <cstdint>

namespace frontlux::detail {

/// 512 neighbouring places for viewpoints at one height: 16 along x and 32 along y, each `stride` voxels from
/// the next. A bit for each, row by row, 16 bits to a row.
struct ViewTile {
  static constexpr int kColumns = 16, kRows = 32;
  static constexpr std::size_t kBytes = kColumns * kRows / 8;
  static constexpr std::size_t kRowBytes = kColumns / 8;
  static constexpr int kMaxStride = 4;

  /// Which bit belongs to a place.
  [[nodiscard]] static constexpr std::uint32_t place(int column, int row) {
    return static_cast<std::uint32_t>(row * kColumns + column);
  }
};

/// The layout in memory of what lies around tiles (`ViewWindow`): what all 512 places find at one offset is
/// `ViewTile::kBytes` in a row. The place in memory is linear in the offset's x and z. Along y, voxels that
/// are a stride apart are neighbours.
struct WindowLayout {
  int reach_x = 0, reach_y = 0, reach_z = 0;  ///< [voxels] largest offsets along each axis
  int stride_x = 1, stride_y = 1;             ///< of the viewpoints: 1, 2 or 4

  /// Rows that are a stride apart, from the first one in reach to the last.
  [[nodiscard]] int run() const { return 2 * reach_y / stride_y + ViewTile::kRows; }
  [[nodiscard]] int rows() const { return stride_y * run(); }
  [[nodiscard]] int columns() const { return 2 * reach_x + 1; }
  [[nodiscard]] std::size_t level_bytes() const {
    return static_cast<std::size_t>(columns()) * static_cast<std::size_t>(rows()) * sizeof(std::uint16_t);
  }
  /// Of an offset, in bytes from the lowest one's.
  [[nodiscard]] std::int32_t offset(int dx, int dy, int dz) const {
    const int y = dy + reach_y;
    const int row = y % stride_y * run() + y / stride_y;
    return static_cast<std::int32_t>(level_bytes()) * (dz + reach_z) +
           static_cast<std::int32_t>(sizeof(std::uint16_t)) * ((dx + reach_x) * rows() + row);
  }
  friend bool operator==(const WindowLayout&, const WindowLayout&) = default;
};

}  // namespace frontlux::detail
