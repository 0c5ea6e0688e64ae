#pragma once

#include "rays/workload.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace frontlux::bench {

/// Targets of one viewpoint; they are sorted by key.
inline constexpr std::size_t kTargetsPerViewpoint = 64;

/// Pairs of free voxels whose centres are `length` apart, to within a voxel, and about 20 degrees off the
/// horizon at most. Viewpoints are in spatial order. Other voxels may block the line between them.
/// @param length  [m]
/// @param within  where viewpoints are
/// @return `count` pairs, or fewer where viewpoints find too few free voxels at that distance
/// @throws std::invalid_argument if the length is not finite or below two voxels
[[nodiscard]] std::vector<KeySegment> segments_of_length(const VoxelGrid& grid, double length,
                                                         std::size_t count,
                                                         const KeyBox& within = kAllVoxels);

/// A ray along each segment, from a random point of its first voxel.
/// @param range  [m]
[[nodiscard]] std::vector<Ray> rays_along(std::span<const KeySegment> segments, const Lattice& lattice,
                                          double range);

/// The same queries in random order, each batch by itself; the same order every time.
[[nodiscard]] Workload shuffled(Workload workload);

}  // namespace frontlux::bench
