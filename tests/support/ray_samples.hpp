#pragma once

#include "support/test.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::test {

/// Rays that look for trouble: origins in free, occupied and unknown voxels and outside the map, on voxel
/// centres, faces, edges and corners; directions at random, along axes and diagonals, towards corners and
/// centres, tiny, huge and not numbers; ranges from tiny to none.
std::vector<Ray> adversarial_rays(const VoxelGrid& grid, std::size_t count, std::uint64_t seed);

/// Pairs of voxels near each other, most of them from a free one: at random, along axes and diagonals,
/// outside the map.
std::vector<KeySegment> adversarial_key_segments(const VoxelGrid& grid, std::size_t count,
                                                 std::uint64_t seed);

/// The same between points: centres, corners and anywhere in the voxels.
std::vector<Segment> adversarial_segments(const VoxelGrid& grid, std::size_t count, std::uint64_t seed);

}  // namespace frontlux::test
