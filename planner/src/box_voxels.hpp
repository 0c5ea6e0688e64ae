#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstdint>

namespace frontlux::planner::detail {

/// Whether `holds(key)` for every voxel of a box; asks no further after the first for which it does not.
template <class Holds>
[[nodiscard]] bool all_of(const KeyBox& box, const Holds& holds) {
  for (unsigned z = box.min.z; z <= box.max.z; ++z)
    for (unsigned y = box.min.y; y <= box.max.y; ++y)
      for (unsigned x = box.min.x; x <= box.max.x; ++x)
        if (!holds(VoxelKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                            static_cast<std::uint16_t>(z)}))
          return false;
  return true;
}

}  // namespace frontlux::planner::detail
