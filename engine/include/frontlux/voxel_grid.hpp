#pragma once

#include <frontlux/export.hpp>
#include <frontlux/key_box.hpp>
#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_storage.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace frontlux {

/// 8 x 8 x 8 voxels as bit planes.
using Brick = detail::Brick;

/// An aligned cube of voxels.
struct Block {
  VoxelKey corner;    ///< its lowest voxel; every coordinate is a multiple of the edge
  int log2_edge = 0;  ///< the edge is 2^log2_edge voxels
};

/// One of the eight blocks that make up a block, numbered as OctoMap numbers children: x counts 1, y 2, z 4.
[[nodiscard]] constexpr Block octant(const Block& block, unsigned number) {
  const int log2_edge = block.log2_edge - 1;
  const auto step = [&](unsigned axis) { return ((number >> axis) & 1U) << log2_edge; };
  const VoxelKey& low = block.corner;
  return {make_key(low.x + step(0), low.y + step(1), low.z + step(2)), log2_edge};
}

/// Which voxels of a map are unknown, free and occupied: a sparse, ternary mirror of an octree in bricks of 8
/// x 8 x 8 voxels, over the whole key range. Large uniform regions are one entry, so memory grows with
/// what is mapped in detail.
///
/// A copy costs nothing and is a snapshot: copies share their bricks until one of them is written to.
///
/// Thread safety: as a standard container. Copies in different threads are independent.
class FRONTLUX_EXPORT VoxelGrid {
 public:
  /// A grid of unknown voxels.
  /// @param resolution edge length of a voxel [m]
  /// @throws std::invalid_argument unless it is finite and positive
  explicit VoxelGrid(double resolution);

  /// The lattice of the voxels.
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }
  /// Edge of a voxel [m].
  [[nodiscard]] double resolution() const { return lattice_.resolution(); }

  /// The state of a voxel.
  [[nodiscard]] Occupancy at(const VoxelKey& key) const { return brick(key).at(key); }

  /// The brick that holds a voxel.
  [[nodiscard]] const Brick& brick(const VoxelKey& key) const { return tile(key).brick(key); }

  /// Changes one voxel.
  void set(const VoxelKey& key, Occupancy state) { fill({key, 0}, state); }

  /// Changes all voxels of a block, in time that does not grow with its volume.
  /// @throws std::invalid_argument if the block is not aligned or larger than the key range, or for no
  ///         `Occupancy`
  void fill(const Block& block, Occupancy state);

  /// Calls `visit` for every largest block of the storage that is not entirely unknown: with the brick if the
  /// block is a brick of mixed states (`log2_edge` 3), else with null and the one state of all its voxels. In
  /// order of storage.
  void for_each_block(const std::function<void(const Block&, const Brick*, Occupancy)>& visit) const;

  /// The smallest box that holds every voxel that is free or occupied; none if all are unknown.
  [[nodiscard]] std::optional<KeyBox> known_bounds() const;

  /// Number of voxels by state, indexed by `Occupancy`, over the whole key range.
  [[nodiscard]] std::array<std::uint64_t, 3> count() const;

  /// Bytes of the bricks and tables that this grid holds; parts shared with copies count in full.
  [[nodiscard]] std::size_t memory_bytes() const;

  /// True if every voxel has the same state in both, and the resolutions are equal.
  friend FRONTLUX_EXPORT bool operator==(const VoxelGrid& a, const VoxelGrid& b);

  /// The storage behind the grid, for the casters' inner loops.
  [[nodiscard]] const detail::Tile& tile(const VoxelKey& key) const {
    return *world_->child(key)->child(key)->child(key);
  }
  /// How the voxels are stored; for the engine itself.
  [[nodiscard]] const detail::Shared<detail::World>& storage() const { return world_; }

  friend void for_each_change(const VoxelGrid& before, const VoxelGrid& after,
                              const std::function<void(const Block&)>& visit);

 private:
  Lattice lattice_;
  detail::Shared<detail::World> world_;
};

/// Every voxel in a state, sorted.
/// @throws std::invalid_argument for unknown voxels, which fill the rest of the key range
/// @throws std::length_error if there are more than `kMostListedKeys`
[[nodiscard]] FRONTLUX_EXPORT std::vector<VoxelKey> keys_in(const VoxelGrid& grid, Occupancy state);

inline constexpr std::uint64_t kMostListedKeys = std::uint64_t{1} << 28;

/// Calls `visit` for blocks that together hold every voxel whose state differs: bricks, or larger blocks that
/// became or were uniform. Parts that both grids share are not read, so between a grid and its edited
/// copy this costs as much as the edit did.
/// @throws std::invalid_argument if the resolutions differ
FRONTLUX_EXPORT void for_each_change(const VoxelGrid& before, const VoxelGrid& after,
                                     const std::function<void(const Block&)>& visit);

}  // namespace frontlux
