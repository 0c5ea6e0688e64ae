#pragma once

#include "view/exact/ray_trie.hpp"
#include "view/target_index.hpp"
#include "view/exact/trie_walk.hpp"
#include "view/view_reach.hpp"
#include "view/view_render.hpp"

#include <frontlux/view_quality.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace frontlux::detail {

/// The trees of a field of view, by the strides of viewpoints, made when they are first asked for.
/// Thread safety: full.
class RayTries {
 public:
  /// Null if the paths are too many for a tree.
  [[nodiscard]] std::shared_ptr<const RayTrie> get(const ViewReach& reach, int azimuth_bins, int stride_x,
                                                    int stride_y);
  [[nodiscard]] bool knows(int stride_x, int stride_y) const;

 private:
  struct Known {
    int stride_x, stride_y;
    std::shared_ptr<const RayTrie> tree;
  };
  mutable std::mutex mutex_;
  std::vector<Known> known_;
};

/// From how many viewpoints on walks over a tree are sooner done than rays.
struct WalkThresholds {
  std::size_t tile = 24;    ///< in a tile
  std::size_t tree = 2000;  ///< in all such tiles, to repay the making of the tree
};

/// What viewpoints are rendered with, exactly.
struct ExactScene {
  const VoxelGrid& grid;
  const ViewReach& reach;
  const TargetIndex& targets;
  const TrieWalk& walk;
  RayTries& trees;
  int azimuth_bins;
  WalkThresholds thresholds = {};
};

/// Counts all targets in view and visible by walks over the tree of paths, over the current task arena, for
/// those of the viewpoints for which that is worth while.
/// @param viewpoints  sorted
/// @param values      written at `index` of each viewpoint
/// @param bin_hits    likewise, `azimuth_bins` to a viewpoint
/// @return the others, for which nothing is written, sorted; all if the paths are too many for a tree
[[nodiscard]] std::vector<Viewpoint> render_exactly(const ExactScene& scene,
                                                    std::span<const Viewpoint> viewpoints,
                                                    std::span<ViewQuality> values,
                                                    std::span<std::uint32_t> bin_hits);

}  // namespace frontlux::detail
