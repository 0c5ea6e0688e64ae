#pragma once

#include <frontlux/view_region.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
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
    return {static_cast<std::uint16_t>(corner.x + (bit >> 4)),
            static_cast<std::uint16_t>(corner.y + ((bit >> 2) & 3)),
            static_cast<std::uint16_t>(corner.z + (bit & 3))};
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
      const auto along = [number](std::uint16_t from, int shift) {
        return static_cast<std::uint16_t>(from + kBlock * ((number >> shift) & 3));
      };
      return {{along(corner.x, 4), along(corner.y, 2), along(corner.z, 0)},
              blocks[static_cast<std::size_t>(number)]};
    }
  };

  /// @throws std::invalid_argument if the cells span more than 2^24 cubes
  explicit CorridorBlocks(std::span<const VoxelKey> cells);

  [[nodiscard]] bool contains(const VoxelKey& key) const;

  /// False only if there is no cell within these distances of a voxel: along x and y, and along z.
  [[nodiscard]] bool may_be_near(const VoxelKey& voxel, int across, int height) const {
    const auto near = [](int k, int distance, int low, int high) {
      return k + distance >= low && k - distance <= high;
    };
    return near(voxel.x, across, box_.min.x, box_.max.x) && near(voxel.y, across, box_.min.y, box_.max.y) &&
           near(voxel.z, height, box_.min.z, box_.max.z);
  }

  /// Whether most cells have others above and below them.
  [[nodiscard]] bool deep() const { return deep_; }

  /// Appends the cubes with cells from which a voxel may be in view, those nearest to it first.
  void cubes_near(const VoxelKey& voxel, const ViewRegion& view, std::vector<const Cube*>& cubes) const;

 private:
  [[nodiscard]] std::size_t slot(int x, int y, int z) const;

  KeyBox box_;  // around all cells; only if there are any
  bool deep_ = false;
  std::array<int, 3> low_{}, size_{};  // of the cubes, along each axis
  std::vector<std::uint32_t> slots_;   // 1 plus the place of the cube, 0 for none
  std::vector<Cube> cubes_;
};

/// Those of a block's cells from which a voxel may be in view.
[[nodiscard]] BlockCells feasible_cells(const BlockCells& cells, const VoxelKey& voxel,
                                        const ViewRegion& view);

}  // namespace frontlux::planner::detail
