#pragma once

#include "mapping/box_array.hpp"

#include <frontlux/key_box.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Frontiers that touch each other, in a box of bounded size: what a robot looks at from one place.
struct FrontierCluster {
  std::uint32_t id = 0;        ///< stays the same while most of its frontiers do; never used again
  std::uint64_t revision = 0;  ///< another one whenever its frontiers are others
  std::vector<VoxelKey> keys;  ///< sorted
  KeyBox box;                  ///< around them
};

/// The frontiers of a map in clusters. They connect by faces, edges and corners; clusters that reach from one
/// cube of a lattice of cubes into another are cut there, but small pieces stay with a neighbour, up to a
/// bounded width of all together. Only cubes
/// with other frontiers than before are looked at again.
class FrontierClusters {
 public:
  /// @param bounds  of all frontiers
  /// @param edge    [voxels] of a cube, which is larger if a plane in it held less than two of the least
  /// clusters
  /// @param least   [frontiers] smaller clusters are left out
  FrontierClusters(const KeyBox& bounds, int edge, std::size_t least);

  /// @param frontiers  sorted
  void update(std::span<const VoxelKey> frontiers);

  /// By their first key.
  [[nodiscard]] std::span<const FrontierCluster> clusters() const { return clusters_; }

 private:
  using Keys = std::vector<VoxelKey>;
  struct Cube {
    Keys frontiers;                     // sorted
    std::vector<std::uint32_t> pieces;  // numbers
  };

  [[nodiscard]] VoxelKey cube_of(const VoxelKey& key) const {
    return make_key(key.x / edge_, key.y / edge_, key.z / edge_);
  }
  void cut(Cube& cube, const VoxelKey& at);
  [[nodiscard]] std::uint32_t new_piece();
  [[nodiscard]] std::vector<std::uint32_t> pieces_in_order() const;
  [[nodiscard]] std::uint32_t piece_for(std::uint32_t small) const;
  [[nodiscard]] std::vector<Keys> joined_pieces() const;
  void name(FrontierCluster& cluster, std::set<std::uint32_t>& taken);

  int edge_;
  std::size_t least_;
  std::vector<FrontierCluster> clusters_;
  Keys frontiers_;
  std::map<VoxelKey, Cube> cubes_;   // that hold frontiers
  std::vector<Keys> pieces_ = {{}};  // sorted; empty those without a number in use, as 0
  std::vector<std::uint32_t> free_;  // numbers
  BoxArray<std::uint32_t> piece_;    // number of each frontier's; 0 elsewhere
  BoxArray<std::uint32_t> cluster_;  // that each voxel was in last
  std::uint32_t next_id_ = 1;
  std::uint64_t next_revision_ = 1;
};

}  // namespace frontlux::planner::detail
