// castRay, replaced by batches, with a map that grows between them.

#include <frontlux/octomap.hpp>

#include <octomap/OcTree.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

// Rays along a lattice of directions, axis-parallel and diagonal ones among them, from inside and outside.
std::vector<frontlux::Ray> make_rays() {
  std::vector<frontlux::Ray> rays;
  for (const float x : {0.1F, 0.5F, -1.3F, 2.0F})
    for (int i = -6; i <= 6; ++i)
      for (int j = -6; j <= 6; ++j)
        for (int k = -6; k <= 6; ++k) {
          const Eigen::Vector3f direction(static_cast<float>(i), static_cast<float>(j),
                                          static_cast<float>(k));
          rays.push_back({.origin = {x, 0.25F, 0.0F}, .direction = direction, .max_range = 4.0});
        }
  return rays;
}

std::size_t count_differences(const octomap::OcTree& tree, const frontlux::OctreeRayCaster& fast,
                              const std::vector<frontlux::Ray>& rays, bool ignore_unknown) {
  std::vector<frontlux::Hit> hits(rays.size());
  fast.castRays(rays, hits, ignore_unknown);
  std::size_t different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3f& o = rays[i].origin;
    const Eigen::Vector3f& d = rays[i].direction;
    octomap::point3d end;
    const bool hit =
        tree.castRay({o.x(), o.y(), o.z()}, {d.x(), d.y(), d.z()}, end, ignore_unknown, rays[i].max_range);
    const Eigen::Vector3f& e = hits[i].end;
    different += hit != hits[i].occupied() || !same_bits(e.x(), end.x()) || !same_bits(e.y(), end.y()) ||
                 !same_bits(e.z(), end.z());
  }
  return different;
}

}  // namespace

int main() {
  octomap::OcTree tree(0.25);
  frontlux::OctreeRayCaster fast(tree);
  const std::vector<frontlux::Ray> rays = make_rays();

  std::size_t different = 0;
  for (const float distance : {1.0F, 2.0F, 3.0F}) {
    octomap::Pointcloud scan;
    for (int i = -8; i <= 8; ++i)
      for (int j = -8; j <= 8; ++j) {
        scan.push_back(distance, 0.2F * static_cast<float>(i), 0.2F * static_cast<float>(j));
        scan.push_back(0.2F * static_cast<float>(i), -distance, 0.2F * static_cast<float>(j));
      }
    tree.insertPointCloud(scan, {0.1F, 0.1F, 0.1F});
    fast.refresh();
    different += count_differences(tree, fast, rays, false) + count_differences(tree, fast, rays, true);
  }
  std::printf("%zu rays in 6 batches, %zu answers differ from castRay's\n", rays.size(), different);
  return different == 0 ? 0 : 1;
}
