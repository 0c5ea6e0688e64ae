#pragma once

#include <frontlux/export.hpp>
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
  std::uint32_t viewpoint = 0;  ///< index among the viewpoints
  std::uint32_t frontier = 0;   ///< index among the frontiers
  friend constexpr auto operator<=>(const VisiblePair&, const VisiblePair&) = default;
};

/// Which frontiers each viewpoint sees at some yaw: V_ij of the information gain, as a sparse matrix.
class FRONTLUX_EXPORT VisiblePairs {
 public:
  VisiblePairs() = default;

  /// @param pairs  in any order
  /// @throws std::invalid_argument naming a pair that is out of range or given twice
  VisiblePairs(std::size_t viewpoints, std::size_t frontiers, std::span<const VisiblePair> pairs);

  /// Number of viewpoints.
  [[nodiscard]] std::size_t viewpoints() const { return first_.size() - 1; }
  /// Number of frontiers.
  [[nodiscard]] std::size_t frontiers() const { return frontiers_; }
  /// Number of visible pairs.
  [[nodiscard]] std::size_t size() const { return seen_.size(); }

  /// Frontiers that a viewpoint sees, ascending.
  [[nodiscard]] std::span<const std::uint32_t> frontiers_of(std::size_t viewpoint) const {
    return std::span(seen_).subspan(first_[viewpoint], first_[viewpoint + 1] - first_[viewpoint]);
  }

 private:
  std::size_t frontiers_ = 0;
  std::vector<std::size_t> first_{0};  // of each viewpoint in `seen_`, and the end of the last
  std::vector<std::uint32_t> seen_;
};

/// The pairs that are in view at some yaw and visible. Unknown and occupied voxels block; the voxels of the
/// viewpoint and of the frontier do not. Casts one batch of rays for the whole path.
/// @param grid  on whose lattice the keys lie
/// @throws std::invalid_argument if a viewpoint is not finite, or a value of the view is out of bounds
[[nodiscard]] FRONTLUX_EXPORT VisiblePairs visible_pairs(const RayCaster& caster, const VoxelGrid& grid,
                                                         std::span<const Pose> viewpoints,
                                                         std::span<const VoxelKey> frontiers,
                                                         const FieldOfView& view);

/// Centres of voxels [m].
[[nodiscard]] FRONTLUX_EXPORT std::vector<Eigen::Vector3d> centers(const Lattice& lattice,
                                                                   std::span<const VoxelKey> keys);

}  // namespace frontlux::planner
