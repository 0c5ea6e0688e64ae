#pragma once

#include <frontlux/view_region.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace frontlux::planner::detail {

/// All offsets in view of at most this length [voxels], the shortest first.
[[nodiscard]] std::vector<std::array<int, 3>> nearby_offsets(const ViewRegion& view, int length);

/// Some offsets from everywhere in view: `count` or a few less.
[[nodiscard]] std::vector<std::array<int, 3>> spread_offsets(const ViewRegion& view, std::size_t count);

}  // namespace frontlux::planner::detail
