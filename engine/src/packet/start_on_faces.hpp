#pragma once

#include "packet/open_voxels.hpp"

#include <array>
#include <cstdint>

namespace frontlux::detail {

/// A step in an index. What is added below an axis' bits carries up to them.
[[nodiscard]] inline std::uint32_t advanced(std::uint32_t index, std::uint32_t axis, std::uint32_t steps) {
  return (((index | ~axis) + steps) & axis) | (index & ~axis);
}

/// Crosses what a ray that starts on faces of voxels crosses right then, or by rounding before. castRay's
/// order of such crossings does not matter if all voxels around are open.
/// @param first      when the ray crosses each axis for the first time; of those that are crossed, the second
/// @param between    the time between two crossings
/// @param index      of the voxel where it starts, flipped so that every step adds, and then of where it is
/// @param too_close  times that differ by no more cannot be told from each other
/// @return false, and nothing is crossed, if such a voxel is closed, or another crossing not much later
[[nodiscard]] bool cross_at_start(const OpenVoxels& table, std::array<std::int32_t, 3>& first,
                                  const std::array<std::int32_t, 3>& between, std::uint32_t& index,
                                  std::uint32_t flip, std::int32_t too_close);

}  // namespace frontlux::detail
