#include "walk/end_ray.hpp"

#include "walk/free_end.hpp"
#include "walk/walk.hpp"

namespace frontlux::detail {

void end_ray(const VoxelGrid& grid, const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
             UnknownPolicy unknown, const std::optional<VoxelKey>& blocker, Hit& hit) {
  const Lattice& lattice = grid.lattice();
  const auto is_within = [&](double range) {
    return !out_of_range(ray.origin, lattice.center(*blocker), range);
  };
  const double sure = range_of_sure_paths(ray.max_range, ray.origin.cast<double>().lpNorm<1>());
  if (blocker && (!(ray.max_range > 0.0) || is_within(sure))) {
    const Occupancy state = blocker_state(grid, *blocker, unknown);
    return make_hit(lattice, ray, start, direction, stop_in(state), state, *blocker, hit);
  }
  const bool is_close = blocker && is_within(ray.max_range);
  const auto end = is_close ? std::nullopt : find_free_end(lattice, ray, start, direction);
  if (!end) {
    hit = walk_ray(grid, ray, unknown);
    return;
  }
  make_hit(lattice, ray, start, direction, end->stop, grid.at(end->key), end->key, hit);
}

}  // namespace frontlux::detail
