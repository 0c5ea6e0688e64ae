#pragma once

#include "mapping/box_array.hpp"

#include <frontlux/key_box.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace frontlux::planner::detail {

/// What a cluster of frontiers is called; its place among all of them is a whole number.
enum class ClusterId : std::uint32_t { kNone };

/// Frontiers that touch each other, in a box of bounded size: what a robot looks at from one place.
struct FrontierCluster {
  ClusterId id = {};           ///< stays the same while most of its frontiers do
  std::uint64_t revision = 0;  ///< another one whenever its frontiers are others
  std::vector<VoxelKey> keys;  ///< sorted
  KeyBox box;                  ///< around them
};

/// The frontiers of a map in clusters. They connect by faces, edges and corners; clusters that reach from one
/// cube of a lattice of cubes into another are cut there, but small pieces stay with a neighbour, up to a
/// bounded width of all together. Only cubes with other frontiers than before, and clusters in them, are made
/// again.
class FrontierClusters {
 public:
  /// @param bounds  of all frontiers
  /// @param edge    [voxels] of a cube, which is larger if a plane in it held less than two of the least
  /// clusters
  /// @param least   [frontiers] smaller clusters are left out
  FrontierClusters(const KeyBox& bounds, int edge, std::size_t least);

  /// Whether frontiers that are too few for a cluster make one all the same.
  using Exceptions = std::function<bool(std::span<const VoxelKey>)>;

  /// Another least size from now on, or other exceptions than none. All clusters are made again.
  void set_least(std::size_t least, const Exceptions& exceptions = {});
  [[nodiscard]] std::size_t least() const { return least_; }

  /// @param frontiers  sorted
  void update(std::span<const VoxelKey> frontiers, const Exceptions& exceptions = {});

  /// By their first key.
  [[nodiscard]] std::span<const FrontierCluster> clusters() const { return clusters_; }
  /// @pre there is a cluster with this id
  [[nodiscard]] const FrontierCluster& cluster(ClusterId id) const;
  /// The cluster that holds a frontier; `ClusterId::kNone` if it is left out.
  [[nodiscard]] ClusterId cluster_of(const VoxelKey& frontier) const {
    return pieces_[piece_[frontier]].cluster;
  }

 private:
  using Keys = std::vector<VoxelKey>;
  struct Cube {
    Keys frontiers;                     // sorted
    std::vector<std::uint32_t> pieces;  // numbers
  };
  struct Piece {
    Keys keys;  // sorted; empty if its number is not in use
    KeyBox box = {};
    std::uint64_t revision = 0;  // another one whenever its keys may be others
    std::uint32_t joins = 0;     // of a small one: `piece_for`
    ClusterId cluster = {};      // `kNone` if it is in none
  };
  struct Part {
    std::vector<std::uint32_t> pieces;  // in their order
    std::size_t size = 0;               // [frontiers]
  };
  using Ids = std::unordered_set<ClusterId>;
  struct Made {
    std::vector<std::uint64_t> revisions;  // of a cluster's pieces
    ClusterId id;                          // of the cluster
  };

  [[nodiscard]] VoxelKey cube_of(const VoxelKey& key) const {
    return make_key(key.x / edge_, key.y / edge_, key.z / edge_);
  }
  void cut(Cube& cube, const VoxelKey& at);
  [[nodiscard]] std::uint32_t new_piece();
  [[nodiscard]] std::vector<std::uint32_t> pieces_in_order() const;
  [[nodiscard]] std::uint32_t piece_for(std::uint32_t small) const;
  void find_neighbors_of_small_pieces(const std::map<VoxelKey, Keys>& changed);
  [[nodiscard]] std::vector<Part> joined_pieces() const;
  [[nodiscard]] Keys keys_of(const Part& part) const;
  [[nodiscard]] std::vector<std::uint64_t> revisions_of(const Part& part) const;
  [[nodiscard]] FrontierCluster make_cluster(const Part& part, const Ids& taken);
  [[nodiscard]] ClusterId name_for(const Keys& keys, const Ids& taken);
  void make_clusters(const Exceptions& exceptions);

  int edge_;
  std::size_t least_;
  bool has_exceptions_ = false;
  std::vector<FrontierCluster> clusters_;
  Keys frontiers_;
  std::unordered_map<ClusterId, std::size_t> places_;  // among the clusters
  std::unordered_map<std::uint64_t, Made> made_of_;    // by the revisions of the clusters' first pieces
  std::map<VoxelKey, Cube> cubes_;                     // that hold frontiers
  std::vector<Piece> pieces_ = {{}};                   // 0 is never in use
  std::vector<std::uint32_t> free_;                    // numbers
  BoxArray<std::uint32_t> piece_;                      // number of each frontier's; 0 elsewhere
  BoxArray<ClusterId> cluster_;                        // that each voxel was in last
  std::uint32_t next_id_ = 1;
  std::uint64_t next_revision_ = 1;
  std::uint64_t next_piece_revision_ = 1;
};

}  // namespace frontlux::planner::detail
