#include "octomap/octomap_adapter.hpp"

#include <octomap/Pointcloud.h>

namespace frontlux {

octomap::OcTreeKey to_octomap(const VoxelKey& key) { return detail::to_octomap(key); }
octomap::point3d to_octomap(const Eigen::Vector3f& point) { return detail::to_octomap(point); }
VoxelKey from_octomap(const octomap::OcTreeKey& key) { return detail::from_octomap(key); }
Eigen::Vector3f from_octomap(const octomap::point3d& point) { return detail::from_octomap(point); }

octomap::Pointcloud to_pointcloud(std::span<const Hit> hits) {
  octomap::Pointcloud cloud;
  for (const Hit& hit : hits)
    if (hit.occupied()) cloud.push_back(detail::to_octomap(hit.end));
  return cloud;
}

}  // namespace frontlux
