#pragma once

#include "view/azimuth_bins.hpp"
#include "view/target_index.hpp"

#include <frontlux/ray_caster.hpp>
#include <frontlux/view_quality.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::detail {

/// A viewpoint and the index of its value.
struct Viewpoint {
  std::uint64_t code = 0;  ///< `cell_code` of its voxel
  std::uint32_t index = 0;
};

/// Sorted by code, so that the viewpoints of a cube of 8 voxels are next to each other.
[[nodiscard]] std::vector<Viewpoint> sort_viewpoints(std::span<const VoxelKey> viewpoints);

/// Runs of viewpoints in one cube of 8 voxels a side: where each begins, and the end of the last.
[[nodiscard]] std::vector<std::size_t> tiles_of(std::span<const Viewpoint> viewpoints);

/// All that a viewpoint's value depends on.
struct ViewScene {
  const RayCaster& caster;
  const ViewRegion& view;
  const AzimuthBins& azimuth_bins;
  const TargetIndex& targets;
  const ViewQualityOptions& options;
};

/// Renders viewpoints, which are sorted, in tiles over the current task arena.
/// @param values    written at `index` of each viewpoint
/// @param bin_hits  likewise, `azimuth_bins` to a viewpoint; zero before
void render_views(const ViewScene& scene, std::span<const Viewpoint> viewpoints,
                  std::span<ViewQuality> values, std::span<std::uint32_t> bin_hits);

}  // namespace frontlux::detail
