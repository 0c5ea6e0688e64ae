#pragma once

#include <frontlux/planner/information_gain.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// The frontiers of a gain that one of its viewpoints has in view at a yaw, by their places, ascending.
[[nodiscard]] inline std::vector<std::uint32_t> frontiers_in_view(const InformationGain& gain,
                                                                  std::size_t viewpoint, double yaw) {
  const auto seen = gain.frontiers_of(viewpoint);
  std::vector<std::uint8_t> in_view(seen.size());
  gain.in_view(viewpoint, yaw, in_view);
  std::vector<std::uint32_t> frontiers;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (in_view[i] != 0) frontiers.push_back(seen[i]);
  return frontiers;
}

}  // namespace frontlux::planner::detail
