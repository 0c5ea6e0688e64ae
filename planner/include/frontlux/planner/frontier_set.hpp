#pragma once

#include <frontlux/map_change.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace frontlux::planner {

/// Which of its neighbours make an unknown voxel a frontier when they are free.
enum class Adjacency : std::uint8_t {
  kFaces,    ///< the 6 that share a face
  kCorners,  ///< the 26 that share a face, an edge or a corner; these see around the edges of walls
};

/// The frontiers in one node of an octree.
struct FrontierCluster {
  VoxelKey corner;                                 ///< the node's lowest voxel
  std::uint32_t count = 0;                         ///< frontiers in it
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< [m] of the centres of these frontiers
  friend bool operator==(const FrontierCluster&, const FrontierCluster&) = default;
};

/// The frontiers of a map: the unknown voxels inside the bounds that have a free neighbour.
///
/// An update takes time for the bricks around the changed voxels only; the result is the same as of a new
/// set. Thread safety: as a standard container.
class FrontierSet {
 public:
  /// @param bounds  voxels outside are no frontiers; free voxels outside count as neighbours
  FrontierSet(const VoxelGrid& grid, const KeyBox& bounds, Adjacency adjacency = Adjacency::kFaces);
  ~FrontierSet();
  FrontierSet(FrontierSet&&) noexcept;
  FrontierSet& operator=(FrontierSet&&) noexcept;

  /// @param change  since the last update
  void update(const MapChange& change);

  /// All frontiers, sorted. Valid until the next update.
  [[nodiscard]] std::span<const VoxelKey> keys() const;
  [[nodiscard]] std::size_t size() const { return keys().size(); }
  [[nodiscard]] bool contains(const VoxelKey& key) const;

  /// The frontiers by the octree nodes of edge 2^level voxels that hold them, sorted by corner.
  /// @throws std::invalid_argument unless the level is 0 to 16
  [[nodiscard]] std::vector<FrontierCluster> clusters(int level) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
