#pragma once

#include <frontlux/export.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace frontlux {

/// Which neighbours make an unknown voxel a frontier if one of them is free.
enum class Adjacency : std::uint8_t {
  kFaces,    ///< the 6 that share a face
  kCorners,  ///< the 26 that share a face, an edge or a corner; also around the edges of walls
};

/// The frontiers of a map: the unknown voxels inside the bounds that have a free neighbour.
///
/// An update looks at the bricks around the changed voxels, and copies the sorted list if that has changed;
/// the result is the same as that of a new set that does not throw. Thread safety: as a standard container.
class FRONTLUX_EXPORT FrontierSet {
 public:
  /// @param bounds  voxels outside are not frontiers; free voxels outside count as neighbours
  /// @param most    frontiers that there may be at once; each takes up to 24 bytes while they are found
  /// @throws std::length_error if there are more, or if more than 2^22 bricks of 8 x 8 x 8 voxels within the
  ///         bounds are beside blocks of the grid that are free as a whole: a giant one has gigabytes of
  ///         frontiers
  FrontierSet(const VoxelGrid& grid, const KeyBox& bounds, Adjacency adjacency = Adjacency::kFaces,
              std::size_t most = std::size_t{1} << 28);
  ~FrontierSet();
  FrontierSet(FrontierSet&&) noexcept;
  FrontierSet& operator=(FrontierSet&&) noexcept;

  /// @param change  since the last update
  /// @throws std::length_error if there are more frontiers than the constructor was told; the set is as it
  ///         was, and the next change that is given has to hold this one as well
  void update(const MapChange& change);

  /// All frontiers, sorted. Valid until the next update.
  [[nodiscard]] std::span<const VoxelKey> keys() const;
  /// How many frontiers there are.
  [[nodiscard]] std::size_t size() const { return keys().size(); }
  /// Whether a voxel is a frontier.
  [[nodiscard]] bool contains(const VoxelKey& key) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux
