#pragma once

#include <frontlux/key_box.hpp>
#include <frontlux/lattice.hpp>
#include <frontlux/sim/world.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace frontlux::sim {

/// What robots can observe of a voxel of a world.
enum class Truth : std::uint8_t {
  kHidden,   ///< nothing: beyond the bounds, within a solid, or in a room that is closed
  kFree,     ///< no surface passes through it, and it can be reached from the start through such voxels
  kSurface,  ///< not free, but a neighbour of a free voxel
};

/// The voxels whose interior the box meets, by more than a millionth of a voxel.
/// @param bounds [m]
/// @throws std::invalid_argument if the box is empty, flat or not finite, or beyond the lattice's keys
[[nodiscard]] KeyBox voxels_within(const Eigen::AlignedBox3d& bounds, const Lattice& lattice);

/// [m] of the lower face of the voxels with a key along one axis.
[[nodiscard]] inline double lower_face(const Lattice& lattice, int key) {
  return (key - Lattice::kOrigin) * lattice.resolution();
}

/// The voxels of a world that robots can observe. Coverage is measured against them.
///
/// A surface within `kMargin` of a voxel's face counts as lying on the face. It belongs to neither voxel: it
/// is a wall between the two. The mapping shifts end points along their rays by as much, so it maps the
/// voxel behind such a wall as occupied, seen from either side, where that leads beyond the face: of a wall
/// that is not quite on it, slanting rays map the voxel before it. A free voxel therefore has no surface in
/// it (but for the margin), the segment from its centre to that of a free neighbour is free unless there is a
/// wall between them, and free space does not leak through any wall, however thin.
///
/// Takes a byte for each voxel of the bounds. A value; reading is safe from any number of threads.
class GroundTruth {
 public:
  static constexpr double kMargin = 1e-3;  ///< [m] or a quarter of a voxel if that is less

  /// @param resolution edge length of a voxel [m]
  /// @param start [m] a point in free space, in the world frame
  /// @throws std::invalid_argument naming the value, if the resolution, the bounds or the mesh is not valid,
  /// the bounds hold more than 2^31 voxels, the start is outside, or a surface passes through its voxel
  GroundTruth(const World& world, double resolution, const Eigen::Vector3d& start);

  [[nodiscard]] const Lattice& lattice() const { return lattice_; }
  /// The voxels within the world's bounds. If those are where the mesh ends, also the voxels behind a face
  /// on which it does, if they show a wall. Nothing is free there, so that nobody sees out of the world.
  [[nodiscard]] const KeyBox& bounds() const { return bounds_; }

  [[nodiscard]] Truth at(const VoxelKey& key) const;
  /// Whether the voxel is observable: free or surface.
  [[nodiscard]] bool contains(const VoxelKey& key) const { return at(key) != Truth::kHidden; }
  /// Whether a surface passes through the voxel, deeper than the margin; observable or not.
  [[nodiscard]] bool holds_surface(const VoxelKey& key) const;
  /// Whether this voxel and the next one up an axis are free, without a wall between them.
  /// @param axis 0, 1 or 2
  [[nodiscard]] bool open(const VoxelKey& key, std::size_t axis) const;

  [[nodiscard]] std::uint64_t free_voxels() const { return free_voxels_; }
  [[nodiscard]] std::uint64_t surface_voxels() const { return surface_voxels_; }
  [[nodiscard]] std::uint64_t observable_voxels() const { return free_voxels_ + surface_voxels_; }
  [[nodiscard]] std::uint64_t bounding_voxels() const { return size_of(bounds_); }

 private:
  [[nodiscard]] std::size_t index(const VoxelKey& key) const { return place_in(bounds_, key); }
  void check_size() const;
  void flood(std::size_t start, const KeyBox& inside);
  void drop_layers_that_show_nothing(const KeyBox& inside);

  Lattice lattice_;
  KeyBox bounds_;
  std::vector<std::uint8_t> cells_;  // a set of cell::Flag for each voxel, x fastest
  std::uint64_t free_voxels_ = 0, surface_voxels_ = 0;
};

}  // namespace frontlux::sim
