#pragma once

#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/voxel_grid.hpp>

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
};

/// Which cells are open, and the shortest paths from one of them to all others. A cell more than 4 million
/// steps away counts as not connected.
class PathDistances {
 public:
  PathDistances(const CellFrame& frame, PathMetric metric);

  /// Opens the cells for which `open(key)` holds, closes the others, and forgets the paths.
  template <class Open>
  void reset(const Open& open) {
    for (int x = 0; x < frame_.size[0]; ++x)
      for (int y = 0; y < frame_.size[1]; ++y)
        for (int z = 0; z < frame_.size[2]; ++z)
          labels_[number(x, y, z)] = open(frame_.key(x, y, z)) ? kUnreached : kClosed;
  }

  /// Finds the paths from an open cell.
  void spread(const VoxelKey& from);

  [[nodiscard]] bool open(const VoxelKey& key) const;
  /// [cells] nothing if there is no path.
  [[nodiscard]] std::optional<double> distance(const VoxelKey& key) const;
  [[nodiscard]] std::vector<VoxelKey> path_to(const VoxelKey& key) const;

  /// Appends the cells with a path, in order.
  void reached(std::vector<VoxelKey>& cells) const;

 private:
  // A label is 0 for a closed cell, else 1 plus the distance, in units of which a face has 985 and the
  // diagonals of square and cube, to the nearest whole number, 1393 and 1706.
  using Label = std::uint32_t;
  static constexpr Label kClosed = 0, kStart = 1, kUnreached = ~Label{0}, kStraight = 985;
  static constexpr std::size_t kMaxMoves = 26;

  struct Move {
    std::ptrdiff_t offset;    // of the cell's number
    std::array<int, 3> step;  // [cells]
    Label length;
    std::uint32_t corners;  // bits of the moves to the cells whose corners it would cut
  };

  [[nodiscard]] std::size_t number(int x, int y, int z) const {
    return (static_cast<std::size_t>(x + 1) * static_cast<std::size_t>(frame_.size[1] + 2) +
            static_cast<std::size_t>(y + 1)) *
               static_cast<std::size_t>(frame_.size[2] + 2) +
           static_cast<std::size_t>(z + 1);
  }
  [[nodiscard]] Label label(const VoxelKey& key) const;
  [[nodiscard]] std::uint32_t closed_around(std::size_t cell) const;

  CellFrame frame_;
  std::vector<Move> moves_;
  std::vector<Label> labels_;  // of all cells, with a border of closed ones
};

}  // namespace frontlux::planner::detail
