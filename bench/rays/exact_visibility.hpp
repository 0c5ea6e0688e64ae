#pragma once

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <span>

namespace frontlux::bench {

/// Whether each segment is free of blockers by the integer rule of docs/ray_contract.md: the crossings of
/// each axis as fractions, the earliest first, nothing left out. Slow, and shares no code with any caster, so
/// that none is its own judge.
void exact_visibility(const VoxelGrid& grid, std::span<const KeySegment> segments,
                      std::span<std::uint8_t> visible, UnknownPolicy unknown);

}  // namespace frontlux::bench
