#include "mapping/scan_voxels.hpp"

#include "mapping/voxel_sets.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <memory>
#include <mutex>

namespace frontlux::planner::detail {
namespace {

template <class Voxels>
std::vector<BrickUpdate> update_with(const Voxels& none, const Lattice& lattice, const KeyBox& bounds,
                                     const Eigen::Vector3f& origin, const VoxelKey& start,
                                     std::span<const RayEnd> rays) {
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
  for (const RayEnd& ray : rays)
    if (ray.has_key && ray.hit) hits.add(places.at(ray.key));
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
                                        const Eigen::Vector3f& origin, std::span<const RayEnd> rays) {
  const VoxelKey start = lattice.key(origin).value();
  KeyBox box{start, start};
  for (const RayEnd& ray : rays)
    if (ray.has_key) box = hull(box, {ray.key, ray.key});
  if (const auto dense = DenseVoxels::make(box))
    return update_with(*dense, lattice, bounds, origin, start, rays);
  return update_with(SparseVoxels{}, lattice, bounds, origin, start, rays);
}

}  // namespace frontlux::planner::detail
