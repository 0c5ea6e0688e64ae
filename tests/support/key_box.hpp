#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstdint>

namespace frontlux::test {

/// Calls `visit` for every voxel of a box.
template <class Visit>
void for_each_key(const KeyBox& box, const Visit& visit) {
  for (unsigned x = box.min.x; x <= box.max.x; ++x)
    for (unsigned y = box.min.y; y <= box.max.y; ++y)
      for (unsigned z = box.min.z; z <= box.max.z; ++z)
        visit(VoxelKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                       static_cast<std::uint16_t>(z)});
}

}  // namespace frontlux::test
