#include "walk/end_ray.hpp"

#include "walk/free_end.hpp"
#include "walk/walk.hpp"

namespace frontlux::detail {

RayEnd end_of(const VoxelGrid& grid, const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
              UnknownPolicy unknown, const std::optional<VoxelKey>& blocker) {
  const Lattice& lattice = grid.lattice();
  if (blocker && is_surely_in_range(ray, lattice.center(*blocker)))
    return {stop_in(blocker_state(grid, *blocker, unknown)), *blocker};
  const bool is_close = blocker && !out_of_range(ray.origin, lattice.center(*blocker), ray.max_range);
  if (!is_close)
    if (const auto end = find_free_end(lattice, ray, start, direction)) return *end;
  const Hit hit = walk_ray(grid, ray, unknown);
  return {hit.stop, hit.key};
}

void make_hit(const VoxelGrid& grid, const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
              const RayEnd& end, Hit& hit) {
  const Occupancy state = end.stop == RayStop::kOccupied  ? Occupancy::kOccupied
                          : end.stop == RayStop::kUnknown ? Occupancy::kUnknown
                                                          : grid.at(end.key);
  make_hit(grid.lattice(), ray, start, direction, end.stop, state, end.key, hit);
}

}  // namespace frontlux::detail
