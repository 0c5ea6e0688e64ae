#pragma once

#include <frontlux/planner/travel_corridor.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace frontlux::planner::detail {

/// A lattice of cells: every `stride`-th voxel of a box.
struct CellFrame {
  VoxelKey first;
  std::array<int, 3> size{};  ///< [cells]
  int stride = 1;             ///< [voxels]

  /// Number of the cell along each axis; nothing if the key is not that of a cell.
  [[nodiscard]] std::optional<std::array<int, 3>> place(const VoxelKey& key) const;
  [[nodiscard]] VoxelKey key(int x, int y, int z) const {
    return make_key(first.x + x * stride, first.y + y * stride, first.z + z * stride);
  }
  /// The part of it within some cells of a key along each axis.
  [[nodiscard]] CellFrame around(const VoxelKey& middle, int cells) const;
  /// Number of a cell in an array that holds all cells with a border of one.
  [[nodiscard]] std::size_t number(int x, int y, int z) const {
    return (static_cast<std::size_t>(x + 1) * static_cast<std::size_t>(size[1] + 2) +
            static_cast<std::size_t>(y + 1)) *
               static_cast<std::size_t>(size[2] + 2) +
           static_cast<std::size_t>(z + 1);
  }
  /// Of that array.
  [[nodiscard]] std::size_t bordered_size() const {
    return static_cast<std::size_t>(size[0] + 2) * static_cast<std::size_t>(size[1] + 2) *
           static_cast<std::size_t>(size[2] + 2);
  }
};

/// Lengths of moves, in units of which a face has 985 and the diagonals of square and cube, to the nearest
/// whole number, 1393 and 1706.
inline constexpr std::array<std::uint32_t, 4> kMoveLengths = {0, 985, 1393, 1706};

/// From a cell to one next to it.
struct CellMove {
  std::ptrdiff_t offset = 0;  ///< of the cell's number
  std::array<int, 3> step{};  ///< [cells]
  std::uint32_t length = 0;   ///< of `kMoveLengths`
  std::uint32_t corners = 0;  ///< bits of the moves to the cells whose corners it would cut
};

/// All moves of a metric; those along z are left out on a single layer.
[[nodiscard]] std::vector<CellMove> cell_moves(const CellFrame& frame, PathMetric metric);

}  // namespace frontlux::planner::detail
