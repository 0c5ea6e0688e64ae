#pragma once

#include "octomap/quiet_octomap.hpp"
#include "support/test.hpp"

#include <Eigen/Core>

namespace frontlux::test {

/// Whether OctoMap finds out by itself if a point has a key. On 64-bit ARM it takes a coordinate that is not
/// a number for 0, and castRay from there may never return (docs/ray_contract.md, section 6).
inline bool octomap_knows_key(const Eigen::Vector3f& point) {
#ifdef __aarch64__
  return !point.array().isNaN().any();
#else
  static_cast<void>(point);
  return true;
#endif
}

/// The tree's own castRay. On 64-bit ARM it is the one compiled here: Debian's library, where the virtual
/// function is, rounds otherwise.
[[gnu::flatten]] inline bool castray_of(const octomap::OcTree& tree, const octomap::point3d& origin,
                                        const octomap::point3d& direction, octomap::point3d& end,
                                        bool ignore_unknown, double max_range = -1.0) {
#ifdef __aarch64__
  if (!octomap_knows_key({origin.x(), origin.y(), origin.z()})) return false;
  return tree.octomap::OcTree::castRay(origin, direction, end, ignore_unknown, max_range);
#else
  return tree.castRay(origin, direction, end, ignore_unknown, max_range);
#endif
}

}  // namespace frontlux::test
