#pragma once

#include "path_tree.hpp"
#include "target_index.hpp"
#include "tree_walk.hpp"
#include "view_reach.hpp"
#include "view_render.hpp"

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
class PathTrees {
 public:
  /// Null if the paths are too many for a tree.
  [[nodiscard]] std::shared_ptr<const PathTree> get(const ViewReach& reach, int azimuth_bins, int stride_x,
                                                    int stride_y);

 private:
  struct Known {
    int stride_x, stride_y;
    std::shared_ptr<const PathTree> tree;
  };
  std::mutex mutex_;
  std::vector<Known> known_;
};

/// What viewpoints are rendered with, exactly.
struct ExactScene {
  const VoxelGrid& grid;
  const ViewReach& reach;
  const TargetIndex& targets;
  const TreeWalk& walk;
  PathTrees& trees;
  int azimuth_bins;
};

/// Counts all targets in view and visible, for all viewpoints, by walks over the tree of paths, over the
/// current task arena.
/// @param values    written at `index` of each viewpoint
/// @param bin_hits  likewise, `azimuth_bins` to a viewpoint
/// @return false, and nothing is written, if the paths are too many for a tree
bool render_exactly(const ExactScene& scene, std::span<const Viewpoint> viewpoints,
                    std::span<ViewQuality> values, std::span<std::uint32_t> bin_hits);

}  // namespace frontlux::detail
