#pragma once

#include "view/azimuth_bins.hpp"
#include "view/sector_set.hpp"
#include "view/target_index.hpp"

#include <frontlux/ray_caster.hpp>
#include <frontlux/view_quality.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::detail {

/// A viewpoint and the index of its value.
struct Viewpoint {
  std::uint64_t code = 0;  ///< `cell_code` of its voxel
  std::uint32_t index = 0;
};

/// A viewpoint whose value is no longer right.
struct StaleViewpoint {
  std::uint64_t code = 0;
  std::uint32_t index = 0;
  SectorSet sectors = SectorSet::all();       ///< in which its visible targets have to be counted again
  std::optional<std::uint32_t> in_view = {};  ///< number of all targets in view, if known
};

/// Sorted by code, so that the viewpoints of a cube of 8 voxels are next to each other.
[[nodiscard]] std::vector<Viewpoint> sort_viewpoints(std::span<const VoxelKey> viewpoints);

/// Runs of viewpoints in one cube of 8 voxels a side: where each begins, and the end of the last.
template <class Viewpoints>
[[nodiscard]] std::vector<std::size_t> tiles_of(const Viewpoints& viewpoints) {
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < viewpoints.size(); ++i)
    if (i == 0 || viewpoints[i].code >> kBlockCode != viewpoints[i - 1].code >> kBlockCode)
      begins.push_back(i);
  begins.push_back(viewpoints.size());
  return begins;
}

/// All that a viewpoint's value depends on.
struct ViewScene {
  const RayCaster& caster;
  const ViewRegion& view;
  const AzimuthBins& azimuth_bins;
  const TargetIndex& targets;
  const ViewQualityOptions& options;
};

/// Renders viewpoints, which are sorted, in tiles over the current task arena. Of sectors that are not stale
/// the hits stay as they are: then all targets in view have to be drawn, and so if their number is known.
/// @param values    written at `index` of each viewpoint
/// @param bin_hits  likewise, `azimuth_bins` to a viewpoint
void render_views(const ViewScene& scene, std::span<const StaleViewpoint> viewpoints,
                  std::span<ViewQuality> values, std::span<std::uint32_t> bin_hits);

}  // namespace frontlux::detail
