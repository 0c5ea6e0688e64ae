#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace frontlux::bench {

/// The horizontal plane (key z) that has most free voxels, the lowest of them if several have; nothing if
/// no voxel is free.
[[nodiscard]] std::optional<std::uint16_t> fullest_free_plane(const VoxelGrid& grid);

/// At most `count` free voxels, one drawn from each of `count` equal shares of all, in order of storage,
/// which is a spatial order: neighbours follow each other.
/// @param plane  only voxels of this key z, if given
/// @param stream  which random numbers to use
[[nodiscard]] std::vector<VoxelKey> sample_free_voxels(const VoxelGrid& grid, std::size_t count,
                                                       std::optional<std::uint16_t> plane,
                                                       std::uint64_t stream);

}  // namespace frontlux::bench
