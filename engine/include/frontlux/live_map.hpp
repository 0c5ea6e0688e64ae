#pragma once

#include <frontlux/export.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/octomap.hpp>

#include <memory>

namespace frontlux {

/// A tree with its grid and its caster, kept in step by one call.
///
///     octomap::OcTree tree(0.1);
///     frontlux::LiveMap map(tree);
///     tree.insertPointCloud(scan, sensor);
///     const frontlux::MapChange change = map.update();
///     map.caster().cast(rays, hits, frontlux::UnknownPolicy::kBlock);
///     frontiers.update(change);                                           // a FrontierSet
///     image.update(map.caster(), viewpoints, frontiers.keys(), change);   // a ViewQualityImage
///
/// Thread safety: queries of the caster may run at the same time as `update`, which reads the tree and must
/// not run while it changes. As a standard container otherwise: nobody may read or copy `grid()` meanwhile,
/// but `caster().grid()` is a snapshot that may be taken at any time.
class FRONTLUX_EXPORT LiveMap {
 public:
  /// @param tree  must outlive this object, which uses the tree's change detection: nothing else may
  /// @throws std::invalid_argument if the tree has not OctoMap's standard depth
  explicit LiveMap(octomap::OcTree& tree);
  /// The same for a tree with colours.
  explicit LiveMap(octomap::ColorOcTree& tree);
  explicit LiveMap(Octree tree);  ///< shares the tree
  ~LiveMap();
  LiveMap(LiveMap&&) noexcept;
  LiveMap& operator=(LiveMap&&) noexcept;

  /// Takes in what changed in the tree since the last call, in time that grows with the change; where the
  /// map's known bounds grow, with the map. Returns what is new; its grid and
  /// keys are valid until the next call. If it throws, the next call that returns has what is new, unless
  /// that was too much.
  /// @throws std::length_error as `changed_keys` does; grid and caster are up to date all the same
  /// @throws std::invalid_argument as long as the tree has another resolution than this map began with
  MapChange update();

  /// The same by reading the whole tree: after calls that OctoMap reports no change for (`OctreeMirror`).
  MapChange rebuild();

  /// What the tree held at the last update; a copy is a snapshot.
  [[nodiscard]] const VoxelGrid& grid() const;
  /// Answers from `grid()`; valid as long as this object, wherever it is moved to.
  [[nodiscard]] const RayCaster& caster() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux
