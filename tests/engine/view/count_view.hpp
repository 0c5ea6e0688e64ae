#pragma once

#include "support/views.hpp"

namespace frontlux::test {

/// How many targets are in view at some yaw, how many of them are visible, and in which bins of azimuth.
struct ViewCount {
  std::uint32_t in_view = 0, visible = 0;
  std::vector<std::uint32_t> bins;
};

/// Target by target, with the field of view's own test.
/// @param sees  whether a target is visible
template <class Sees>
ViewCount count_view(const VoxelKey& from, const std::vector<VoxelKey>& targets, const FieldOfView& view,
                     double resolution, int bins, const Sees& sees) {
  ViewCount count{0, 0, std::vector<std::uint32_t>(static_cast<std::size_t>(bins))};
  for (const VoxelKey& to : targets) {
    const Eigen::Vector3d offset = offset_between(from, to, resolution);
    if (!view.contains_at_some_yaw(offset)) continue;
    ++count.in_view;
    if (!sees(to)) continue;
    ++count.visible;
    if (bins == 0) continue;
    double degrees = std::atan2(offset.y(), offset.x()) / kDegree;
    if (degrees < 0) degrees += 360;
    // Axes and diagonals lie on borders of bins, exactly.
    ++count.bins[static_cast<std::size_t>(degrees * bins / 360 + 1e-9) % count.bins.size()];
  }
  return count;
}

}  // namespace frontlux::test
