#pragma once

#include <frontlux/ray_caster.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// For each segment 1 if no occupied or unknown voxel lies before its end, else 0.
[[nodiscard]] inline std::vector<std::uint8_t> visible_segments(const RayCaster& caster,
                                                                std::span<const KeySegment> segments) {
  std::vector<std::uint8_t> visible(segments.size());
  caster.visible(segments, visible, UnknownPolicy::kBlock);
  return visible;
}

}  // namespace frontlux::planner::detail
