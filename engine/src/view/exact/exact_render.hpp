#pragma once

#include "view/exact/places_in_view.hpp"
#include "view/exact/ray_trie.hpp"
#include "view/exact/sector_walker.hpp"
#include "view/exact/trie_walk.hpp"
#include "view/target_index.hpp"
#include "view/view_render.hpp"

#include <frontlux/view_quality.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace frontlux::detail {

/// What the walks for viewpoints of one stride look up.
struct WalkTables {
  RayTrie trie;
  PlacesInView in_view;
};

/// The tries of a field of view, by the strides of viewpoints. Each is made when it is needed for the first
/// time. Thread safety: full.
class RayTries {
 public:
  /// Null if the rays are too many for a trie, or if there is none yet and `make` is false.
  [[nodiscard]] std::shared_ptr<const WalkTables> get(const ViewRegion& view, int azimuth_bins, int stride_x,
                                                      int stride_y, bool make);

 private:
  struct Known {
    int stride_x, stride_y;
    std::shared_ptr<const WalkTables> tables;
  };
  std::mutex mutex_;
  std::vector<Known> known_;
};

/// All that a viewpoint's exact value depends on.
struct ExactScene {
  const VoxelGrid& grid;
  const ViewRegion& view;
  const TargetIndex& targets;
  const TrieWalk& walk;
  RayTries& tries;
  int azimuth_bins;
  WalkThresholds thresholds = {};
};

/// Counts all targets in view and visible by walks over the trie of rays, for the viewpoints for which that
/// takes less time than rays. Runs in the current task arena.
/// @param viewpoints  sorted
/// @param values      written at `index` of each viewpoint
/// @param bin_hits    likewise, `azimuth_bins` to a viewpoint; of sectors that are not stale they stay
/// @return what is left to rays, sorted: viewpoints, or the rest of their sectors with what is in view. All
/// if the rays are too many for a trie
[[nodiscard]] std::vector<StaleViewpoint> render_exactly(const ExactScene& scene,
                                                         std::span<const StaleViewpoint> viewpoints,
                                                         std::span<ViewQuality> values,
                                                         std::span<std::uint32_t> bin_hits);

}  // namespace frontlux::detail
