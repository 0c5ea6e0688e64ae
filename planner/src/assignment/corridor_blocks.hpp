#pragma once

#include "mapping/box_array.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/view_region.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Some cells of a block of 4 x 4 x 4 voxels: bit 16 x + 4 y + z.
struct BlockCells {
  VoxelKey corner;
  std::uint64_t bits = 0;

  [[nodiscard]] VoxelKey key(int bit) const {
    return make_key(corner.x + (bit >> 4), corner.y + ((bit >> 2) & 3), corner.z + (bit & 3));
  }
};

/// The cells of a corridor as bits, in cubes of 16 voxels that hold blocks of 4.
class CorridorBlocks {
 public:
  static constexpr int kBlock = 4, kCube = 16;

  struct Cube {
    VoxelKey corner;
    std::uint64_t filled = 0;  ///< the blocks that hold cells
    std::array<std::uint64_t, 64> blocks{};

    [[nodiscard]] BlockCells block(int number) const {
      return {make_key(corner.x + kBlock * (number >> 4), corner.y + kBlock * ((number >> 2) & 3),
                       corner.z + kBlock * (number & 3)),
              blocks[static_cast<std::size_t>(number)]};
    }
    /// Calls `visit` with every block that holds cells.
    template <class Visit>
    void for_each_block(const Visit& visit) const {
      for (std::uint64_t rest = filled; rest != 0; rest &= rest - 1) visit(block(std::countr_zero(rest)));
    }
  };

  /// @throws std::invalid_argument if the cells span more than 2^24 cubes
  explicit CorridorBlocks(std::span<const VoxelKey> cells);

  [[nodiscard]] bool contains(const VoxelKey& key) const;

  /// False only if no cell lies within these distances of a voxel: along x and y, and along z.
  [[nodiscard]] bool may_be_near(const VoxelKey& voxel, int across, int height) const {
    return grown(bounds_, across, across, height).contains(voxel);
  }

  /// Whether most cells have others above and below them.
  [[nodiscard]] bool deep() const { return deep_; }

  /// The cubes that the region of a voxel may meet, the nearest first.
  [[nodiscard]] std::vector<const Cube*> cubes_near(const VoxelKey& voxel, const ViewRegion& region) const;

 private:
  bool deep_ = false;
  KeyBox bounds_;                   // of all cells
  BoxArray<std::uint32_t> places_;  // of the cubes: 1 plus the index, 0 for none
  std::vector<Cube> cubes_;
};

/// The cells of a block from which a voxel may be in view.
[[nodiscard]] BlockCells feasible_cells(const BlockCells& cells, const VoxelKey& voxel,
                                        const ViewRegion& region);

}  // namespace frontlux::planner::detail
