#pragma once

#include <frontlux/field_of_view.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner {

/// One viewpoint of a path and one frontier that it sees at some yaw, by their places in their lists.
struct VisiblePair {
  std::uint32_t viewpoint = 0, frontier = 0;
  friend constexpr auto operator<=>(const VisiblePair&, const VisiblePair&) = default;
};

/// Which frontiers can be seen from which viewpoints: V_ij of the information gain, as a sparse matrix with
/// an index both ways. Yaw plays no part.
class VisiblePairs {
 public:
  VisiblePairs() = default;

  /// @param pairs  in any order
  /// @throws std::invalid_argument naming a pair that is out of range or there twice
  VisiblePairs(std::size_t viewpoints, std::size_t frontiers, std::span<const VisiblePair> pairs);

  [[nodiscard]] std::size_t viewpoints() const { return by_viewpoint_.first.size() - 1; }
  [[nodiscard]] std::size_t frontiers() const { return by_frontier_.first.size() - 1; }
  [[nodiscard]] std::size_t size() const { return by_viewpoint_.other.size(); }

  /// Frontiers seen from a viewpoint, ascending.
  [[nodiscard]] std::span<const std::uint32_t> frontiers_of(std::size_t viewpoint) const {
    return by_viewpoint_.row(viewpoint);
  }
  /// Viewpoints that see a frontier, ascending.
  [[nodiscard]] std::span<const std::uint32_t> viewpoints_of(std::size_t frontier) const {
    return by_frontier_.row(frontier);
  }

 private:
  struct Index {
    std::vector<std::size_t> first{0};  // of each row, and the end of the last
    std::vector<std::uint32_t> other;
    [[nodiscard]] std::span<const std::uint32_t> row(std::size_t i) const {
      return std::span(other).subspan(first[i], first[i + 1] - first[i]);
    }
  };
  Index by_viewpoint_, by_frontier_;
};

/// The pairs that some yaw brings into view and between which nothing stands: unknown and occupied voxels
/// block, the voxels of the viewpoint and of the frontier do not. One batch of rays for a whole path.
/// @param grid  on whose lattice the keys lie
/// @throws std::invalid_argument if a viewpoint is not finite or the field of view is none
[[nodiscard]] VisiblePairs visible_pairs(const RayCaster& caster, const VoxelGrid& grid,
                                         std::span<const Pose> viewpoints,
                                         std::span<const VoxelKey> frontiers, const FieldOfView& view);

/// Centres of voxels [m].
[[nodiscard]] std::vector<Eigen::Vector3d> centers(const Lattice& lattice, std::span<const VoxelKey> keys);

/// @throws std::invalid_argument naming the first viewpoint that is not finite
void check_finite(std::span<const Pose> viewpoints);

}  // namespace frontlux::planner
