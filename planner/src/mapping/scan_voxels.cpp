#include "mapping/scan_voxels.hpp"

#include "mapping/voxel_sets.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>

namespace frontlux::planner::detail {
namespace {

constexpr int kBeyond = 2;  // [voxels] more than a path may be off by rounding

// [m] How far a ray from inside the bounds has to be followed, so that it has left them for certain.
double reach_to_leave(const Lattice& lattice, const KeyBox& bounds, const Eigen::Vector3f& origin,
                      const Eigen::Vector3f& end) {
  const Eigen::Vector3d from = origin.cast<double>(), along = (end.cast<double>() - from).normalized();
  const Eigen::Array3d beyond = Eigen::Array3d::Constant((kBeyond + 0.5) * lattice.resolution());
  const Eigen::Vector3d low = lattice.exact_center(bounds.min).array() - beyond,
                        high = lattice.exact_center(bounds.max).array() + beyond;
  double reach = std::numeric_limits<double>::infinity();
  for (Eigen::Index a = 0; a < 3; ++a)
    if (along[a] != 0.0) reach = std::min(reach, ((along[a] > 0.0 ? high : low)[a] - from[a]) / along[a]);
  return reach;
}

// Shortens rays that leave the bounds. Returns a box around all that rays pass in the key range.
KeyBox limit(const Lattice& lattice, const KeyBox& bounds, const Eigen::Vector3f& origin,
             const VoxelKey& start, std::span<ScanRay> rays) {
  KeyBox box{start, start};
  const KeyBox around = grown(bounds, kBeyond + 2);
  for (ScanRay& ray : rays) {
    if (!ray.has_key) continue;
    VoxelKey last = ray.key;
    if (bounds.contains(start) && !bounds.contains(ray.key)) {
      ray.reach = reach_to_leave(lattice, bounds, origin, ray.point);
      last = {std::clamp(last.x, around.min.x, around.max.x), std::clamp(last.y, around.min.y, around.max.y),
              std::clamp(last.z, around.min.z, around.max.z)};
    }
    box = hull(box, {last, last});
  }
  return box;
}

template <class Voxels>
std::vector<BrickUpdate> update_with(const Voxels& none, const Lattice& lattice, const KeyBox& bounds,
                                     const Eigen::Vector3f& origin, const VoxelKey& start,
                                     std::span<const ScanRay> rays) {
  constexpr std::size_t kGrain = 1024;
  const LinearPlaces places = none.places();
  // Sets that no thread is filling; there are never more than threads.
  std::vector<std::unique_ptr<Voxels>> passed;
  std::mutex mutex;
  for_each_chunk(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<Voxels> voxels;
    if (const std::lock_guard lock(mutex); !passed.empty()) {
      voxels = std::move(passed.back());
      passed.pop_back();
    }
    if (!voxels) voxels = std::make_unique<Voxels>(none);
    for_each_passed(lattice, origin, start, rays.subspan(begin, end - begin), places,
                    [&](unsigned lane, std::int64_t place) { return voxels->add(place, lane); });
    const std::lock_guard lock(mutex);
    passed.push_back(std::move(voxels));
  });
  Voxels all = none, hits = none;
  for (const auto& voxels : passed) all.add(*voxels);
  for (const ScanRay& ray : rays)
    if (ray.has_key && ray.hit && bounds.contains(ray.key)) hits.add(places.at(ray.key));
  all.add(hits);

  std::vector<BrickUpdate> updates;
  all.for_each_brick([&](const VoxelKey& corner) {
    const Layers inside = frontlux::detail::part_inside(corner, bounds), hit = hits.brick(corner);
    Layers miss = all.brick(corner), hit_inside{};
    std::uint64_t any = 0;
    for (std::size_t z = 0; z < 8; ++z) {
      hit_inside[z] = hit[z] & inside[z];
      miss[z] &= inside[z] & ~hit[z];
      any |= hit_inside[z] | miss[z];
    }
    if (any != 0) updates.push_back({brick_number(corner), corner, to_octants(miss), to_octants(hit_inside)});
  });
  std::sort(updates.begin(), updates.end(),
            [](const BrickUpdate& a, const BrickUpdate& b) { return a.number < b.number; });
  return updates;
}

}  // namespace

std::vector<BrickUpdate> voxels_of_scan(const Lattice& lattice, const KeyBox& bounds,
                                        const Eigen::Vector3f& origin, std::span<ScanRay> rays) {
  const VoxelKey start = lattice.key(origin).value();
  const KeyBox box = limit(lattice, bounds, origin, start, rays);
  if (const auto dense = DenseVoxels::make(box))
    return update_with(*dense, lattice, bounds, origin, start, rays);
  return update_with(SparseVoxels{}, lattice, bounds, origin, start, rays);
}

}  // namespace frontlux::planner::detail
