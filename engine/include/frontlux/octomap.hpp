#pragma once

#include <frontlux/export.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <filesystem>
#include <memory>
#include <span>
#include <variant>

// Forward declarations only: include <octomap/OcTree.h> or <octomap/ColorOcTree.h> where you use OctoMap's
// types.
namespace octomath {
class Vector3;
}
namespace octomap {
class OcTree;
class ColorOcTree;
class OcTreeKey;
class Pointcloud;
using point3d = octomath::Vector3;
}  // namespace octomap

namespace frontlux {

/// OctoMap's types for ours and back, exact in both directions.
[[nodiscard]] FRONTLUX_EXPORT octomap::OcTreeKey to_octomap(const VoxelKey& key);
[[nodiscard]] FRONTLUX_EXPORT octomap::point3d to_octomap(const Eigen::Vector3f& point);
[[nodiscard]] FRONTLUX_EXPORT VoxelKey from_octomap(const octomap::OcTreeKey& key);
[[nodiscard]] FRONTLUX_EXPORT Eigen::Vector3f from_octomap(const octomap::point3d& point);

/// The centres of the occupied voxels that rays ended in, in the order of the hits: what `castRay` would add
/// to a cloud for each ray that it returns true for.
[[nodiscard]] FRONTLUX_EXPORT octomap::Pointcloud to_pointcloud(std::span<const Hit> hits);

/// A tree read from a file, of the kind the file holds. Whatever takes one refuses a null pointer:
/// std::invalid_argument.
using Octree = std::variant<std::shared_ptr<octomap::OcTree>, std::shared_ptr<octomap::ColorOcTree>>;

/// Reads an OctoMap file, `.bt` or `.ot`, by its header and not by its name. The file is checked from end to
/// end before OctoMap's own reader, which trusts its input, sees it.
/// @throws std::runtime_error naming the file, what is wrong with it and where, or that its nodes would
///         not fit into `available_memory()`
[[nodiscard]] FRONTLUX_EXPORT Octree read_octree(const std::filesystem::path& file);

/// Writes a tree in OctoMap's format: the log-odds of every node (and its colour) to a file named `.ot`, free
/// and occupied only to one named `.bt`. The file appears complete or not at all, in place of a link of its
/// name, too.
/// @throws std::invalid_argument if the name ends otherwise, or for what `read_octree` would refuse: voxels
///         smaller than 1e-9 m or larger than 1e9 m, a `.bt` of a single leaf as large as the key range
/// @throws std::runtime_error naming the file, if it cannot be written
FRONTLUX_EXPORT void write_octree(const octomap::OcTree& tree, const std::filesystem::path& file);
FRONTLUX_EXPORT void write_octree(const octomap::ColorOcTree& tree, const std::filesystem::path& file);
FRONTLUX_EXPORT void write_octree(const Octree& tree, const std::filesystem::path& file);

/// The ternary mirror of a tree: occupied, free and unknown by the tree's own `search` and `isNodeOccupied`.
/// A pruned leaf is one entry, however large.
[[nodiscard]] FRONTLUX_EXPORT VoxelGrid make_voxel_grid(const octomap::OcTree& tree);
[[nodiscard]] FRONTLUX_EXPORT VoxelGrid make_voxel_grid(const octomap::ColorOcTree& tree);
[[nodiscard]] FRONTLUX_EXPORT VoxelGrid make_voxel_grid(const Octree& tree);

/// About the memory that the mirror of a tree will take, and no less than its `memory_bytes()`: up to 3 kB
/// for each voxel if they lie far apart.
[[nodiscard]] FRONTLUX_EXPORT std::size_t voxel_grid_bytes(const Octree& tree);

/// Keeps a VoxelGrid in step with one tree.
///
/// OctoMap's change detection reports the keys that updates and scan insertions changed, but not what
/// `setOccupancyThres`, `clear`, `deleteNode`, `setNodeValue`, a file read into the tree or direct
/// writes to nodes changed (docs/ray_contract.md), nor what was changed while it was switched off. After any
/// of those call `rebuild`.
class FRONTLUX_EXPORT OctreeMirror {
 public:
  /// @param tree  watched by reference: must outlive the mirror. For `update` to be incremental, call
  ///              `tree.enableChangeDetection(true)` and `tree.resetChangeDetection()` before.
  explicit OctreeMirror(const octomap::OcTree& tree);
  /// The same for a tree with colours.
  explicit OctreeMirror(const octomap::ColorOcTree& tree);
  explicit OctreeMirror(const Octree& tree);  ///< shares the tree
  explicit OctreeMirror(const octomap::OcTree&& tree) = delete;
  explicit OctreeMirror(const octomap::ColorOcTree&& tree) = delete;
  ~OctreeMirror();
  OctreeMirror(OctreeMirror&&) noexcept;
  OctreeMirror& operator=(OctreeMirror&&) noexcept;

  /// The mirror.
  [[nodiscard]] const VoxelGrid& grid() const;

  /// Reads the keys that the tree reports as changed; call `tree.resetChangeDetection()` afterwards. Rebuilds
  /// if those keys are seen to be incomplete: change detection was off at the last update, or since then the
  /// tree has got another root or occupancy threshold. After `clear`, a tree that is filled again may have
  /// its root in the same place: call `rebuild`.
  /// @return true if it was incremental, false if it rebuilt
  bool update();

  /// Reads the whole tree.
  void rebuild();

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
};

/// OctoMap's own castRay, unchanged, behind the common interface: the baseline. `visible` calls castRay for
/// the ray between the two points; its answer depends on rounding, and a ray that passes beside the voxel of
/// its end counts, so that in rare cases it differs from the other casters' (docs/ray_contract.md, 7).
/// @param tree  queried by reference: must outlive the caster and not change during a query; queries throw
/// std::invalid_argument once its resolution is another one. `update` does nothing.
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_octomap_ray_caster(const octomap::OcTree& tree);
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_octomap_ray_caster(
    const octomap::ColorOcTree& tree);
/// The same for what `read_octree` returns, which the caster shares.
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_octomap_ray_caster(const Octree& tree);
std::unique_ptr<RayCaster> make_octomap_ray_caster(const octomap::OcTree&& tree) = delete;
std::unique_ptr<RayCaster> make_octomap_ray_caster(const octomap::ColorOcTree&& tree) = delete;

/// A drop-in for `tree.castRay(...)`: the same signature, the same results bit for bit, many times faster.
///
///     frontlux::OctreeRayCaster fast(tree);
///     bool hit = fast.castRay(origin, direction, end);
///
/// It answers from a snapshot of the tree, taken at construction and by `refresh`. It prints none of
/// OctoMap's warnings. Thread safety: const members may run at the same time as each other and as `refresh`,
/// which reads the tree and must not run while that changes; a query answers from the snapshot as it was when
/// the query began. Calls of `refresh` must not overlap, and one after the tree's resolution has changed must
/// not run at the same time as anything else.
class FRONTLUX_EXPORT OctreeRayCaster {
 public:
  /// @param tree  read now and by `refresh`: must outlive this object
  explicit OctreeRayCaster(const octomap::OcTree& tree);
  /// The same for a tree with colours.
  explicit OctreeRayCaster(const octomap::ColorOcTree& tree);
  explicit OctreeRayCaster(const Octree& tree);  ///< shares the tree
  explicit OctreeRayCaster(const octomap::OcTree&& tree) = delete;
  explicit OctreeRayCaster(const octomap::ColorOcTree&& tree) = delete;
  ~OctreeRayCaster();
  OctreeRayCaster(OctreeRayCaster&&) noexcept;
  OctreeRayCaster& operator=(OctreeRayCaster&&) noexcept;

  /// As `octomap::OcTree::castRay`: true if the ray ends in an occupied voxel. `end` becomes the centre of
  /// the voxel in which it ended, and stays as it was where castRay leaves it untouched.
  /// @param maxRange [m] no limit if <= 0
  bool castRay(const octomap::point3d& origin, const octomap::point3d& direction, octomap::point3d& end,
               bool ignoreUnknownCells = false, double maxRange = -1.0) const;

  /// The same for many rays, on all cores: `hits[i]` belongs to `rays[i]`.
  /// @throws std::invalid_argument if the spans differ in size
  void castRays(std::span<const Ray> rays, std::span<Hit> hits, bool ignoreUnknownCells = false) const;

  /// Takes a new snapshot, after any change of the tree, by reading all of it.
  void refresh();

  /// The queries beyond castRay's: visibility between points and between voxels, and counts along paths.
  /// Valid as long as this object, wherever it is moved to, and answers from its latest snapshot; a `refresh`
  /// after the tree's resolution has changed ends it.
  [[nodiscard]] const RayCaster& caster() const;

 private:
  struct Snapshot;
  std::unique_ptr<Snapshot> snapshot_;
};

}  // namespace frontlux
