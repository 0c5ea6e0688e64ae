#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Where a layer of floor carries a robot: no voxel under it is known to be free, and one near its middle is
/// known to be occupied.
class Ground {
 public:
  struct Options {
    KeyBox box;                          ///< floor beyond its columns is unknown
    std::optional<std::uint16_t> layer;  ///< key of the floor along z; without it there is no ground
    int half_x = 0, half_y = 0;          ///< [voxels] from the middle; none within may be free
    int reach = 1;                       ///< [voxels] from the middle; one within has to be occupied
    std::vector<KeyBox> exempt = {};     ///< their columns need no ground
  };
  explicit Ground(Options options);

  void read(const VoxelGrid& grid);
  void read(const VoxelGrid& grid, std::span<const VoxelKey> changed);

  /// @pre x and y of the key lie in the box
  [[nodiscard]] bool carries(const VoxelKey& key) const { return carries_[column(key)] != 0; }

 private:
  using Flags = std::vector<std::uint8_t>;  // one for each column

  [[nodiscard]] std::size_t column(const VoxelKey& key) const {
    return static_cast<std::size_t>(key.x - options_.box.min.x) * static_cast<std::size_t>(size_y_) +
           static_cast<std::size_t>(key.y - options_.box.min.y);
  }
  void read_voxel(const VoxelGrid& grid, const VoxelKey& key);
  [[nodiscard]] Flags spread(const Flags& flags, int by_x, int by_y) const;
  void decide();

  Options options_;
  int size_x_, size_y_;
  Flags free_, occupied_, carries_;
};

}  // namespace frontlux::planner::detail
