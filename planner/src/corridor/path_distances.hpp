#pragma once

#include "corridor/cell_frame.hpp"
#include "corridor/voxel_columns.hpp"

#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace frontlux::planner::detail {

/// Which cells are open, and the shortest paths from one of them to all others. A cell more than 4 million
/// steps away counts as not connected.
class PathDistances {
 public:
  PathDistances(const CellFrame& frame, PathMetric metric);

  /// Opens the cells for which `open(key)` holds, closes the others, and forgets the paths.
  template <class Open>
  void reset(const Open& open) {
    labels_.resize(frame_.bordered_size(), kClosed);
    for (int x = 0; x < frame_.size[0]; ++x)
      for (int y = 0; y < frame_.size[1]; ++y)
        for (int z = 0; z < frame_.size[2]; ++z)
          labels_[frame_.number(x, y, z)] = open(frame_.key(x, y, z)) ? kUnreached : kClosed;
  }

  /// Opens the cells that are set. @pre cells are voxels of the columns' box
  void reset(const VoxelColumns& open);
  /// If there is such a cell.
  void close(const VoxelKey& key);

  /// Finds the paths from an open cell.
  void spread(const VoxelKey& from);

  [[nodiscard]] bool open(const VoxelKey& key) const;
  /// [cells] nothing if there is no path.
  [[nodiscard]] std::optional<double> distance(const VoxelKey& key) const;
  [[nodiscard]] std::vector<VoxelKey> path_to(const VoxelKey& key) const;

  /// Appends the cells with a path, in order.
  void reached(std::vector<VoxelKey>& cells) const;

 private:
  // A label is 0 for a closed cell, else 1 plus the distance in the units of `kMoveLengths`.
  using Label = std::uint32_t;
  static constexpr Label kClosed = 0, kStart = 1, kUnreached = ~Label{0}, kStraight = kMoveLengths[1];
  static constexpr std::size_t kMaxMoves = 26;

  [[nodiscard]] Label label(const VoxelKey& key) const;
  [[nodiscard]] std::uint32_t closed_around(std::size_t cell) const;

  CellFrame frame_;
  std::vector<CellMove> moves_;
  std::vector<Label> labels_;  // of all cells, with a border of closed ones; empty before the first reset
};

}  // namespace frontlux::planner::detail
