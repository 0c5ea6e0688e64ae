#pragma once

#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// A box of voxels relative to one, both ends included.
struct VoxelWindow {
  std::array<int, 3> low{}, high{};
};

/// The voxels of a box around which a whole window is free.
///
/// Each x and y has a column of bits along z. A window is tested by ANDs along one axis after the other. The
/// result of each axis is kept, so that a change renews only the columns around it.
class Erosion {
 public:
  /// @param box     voxels outside are not free
  /// @param window  holds the origin
  Erosion(const KeyBox& box, const VoxelWindow& window);

  void read(const VoxelGrid& grid);
  void read(const VoxelGrid& grid, std::span<const VoxelKey> changed);

  [[nodiscard]] bool whole(const VoxelKey& key) const {
    if (!box_.contains(key)) return false;
    const int z = key.z - base_z_;
    return ((whole_[column(key.x - box_.min.x, key.y - box_.min.y) + static_cast<std::size_t>(z >> 6)] >>
             (z & 63)) &
            1U) != 0;
  }

 private:
  using Bits = std::vector<std::uint64_t>;
  using Flags = std::vector<std::uint8_t>;  // one for each column

  [[nodiscard]] std::size_t column(int x, int y) const {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_y_) + static_cast<std::size_t>(y)) *
           words_;
  }
  void read_brick(const VoxelGrid& grid, const VoxelKey& corner);
  void erode();
  void erode_along_z(std::size_t column);
  template <int kAxis>
  void erode_across(const Bits& from, Bits& to, const Flags& stale_from, Flags& stale_to);

  KeyBox box_;
  VoxelWindow window_;
  int base_z_, size_x_, size_y_;
  std::size_t words_;  // in a column
  Bits free_, free_z_, free_yz_, whole_;
  Flags stale_, stale_yz_, stale_xyz_;
};

}  // namespace frontlux::planner::detail
