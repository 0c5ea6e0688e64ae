#include "walk.hpp"

#include <algorithm>

namespace frontlux::detail {
namespace {

// Of a direction as castRay walks along it: what is not a number acts as 0, and beside an infinite component the
// others do too.
Eigen::Vector3d unit_vector(const Eigen::Vector3f& direction) {
  Eigen::Array3d d = direction.cast<double>().array();
  d = d.isNaN().select(0.0, d);
  if (d.isInf().any()) d = d.isInf().select(d.sign(), 0.0);
  return d.matrix().normalized();
}

}  // namespace

Hit make_hit(const Lattice& lattice, const Ray& ray, const VoxelKey& origin_key,
             const Eigen::Vector3f& direction, RayStop stop, Occupancy state, const VoxelKey& key) {
  Hit hit{stop, state, key, lattice.center(key), ray.origin, 0.0F};
  if (key == origin_key) return hit;
  const Eigen::Vector3d unit = unit_vector(direction);
  const Eigen::Vector3d origin = ray.origin.cast<double>();
  const std::array<int, 3> cell = as_array(key);
  double distance = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (!(std::fabs(unit[i]) > 0.0)) continue;
    const int face = cell[static_cast<std::size_t>(i)] - Lattice::kOrigin + (unit[i] > 0.0 ? 0 : 1);
    distance = std::max(distance, (face * lattice.resolution() - origin[i]) / unit[i]);
  }
  hit.entry = (origin + distance * unit).cast<float>();
  hit.distance = static_cast<float>(distance);
  return hit;
}

Hit walk_ray(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown) {
  const Lattice& lattice = grid.lattice();
  const auto start = lattice.key(ray.origin);
  if (!start) return {};
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  const auto end_in = [&](RayStop stop, Occupancy state, const std::array<int, 3>& key) {
    return make_hit(lattice, ray, *start, direction, stop, state, as_key(key));
  };

  GridCursor cursor(grid, unknown, *start);
  Walk<double> walk = make_walk(lattice, ray.origin, *start, direction);
  const Occupancy origin_state = cursor.state(walk.key);
  if (blocks(origin_state, unknown)) return end_in(stop_in(origin_state), origin_state, walk.key);
  if (walk.stands_still()) return {};

  const double range_matters_from = time_surely_in_range(ray.max_range, lattice.resolution(), direction);
  while (true) {
    const int axis = walk.next_axis();
    const auto a = static_cast<std::size_t>(axis);
    if (walk.at_last_key(axis)) return end_in(RayStop::kLeftMap, cursor.state(walk.key), walk.key);
    const int before = walk.key[a];
    const double t = walk.t_max[a];
    walk.advance(axis);
    cursor.moved(walk.key, before ^ walk.key[a]);
    if (t >= range_matters_from && out_of_range(ray.origin, lattice.center(as_key(walk.key)), ray.max_range))
      return end_in(RayStop::kOutOfRange, cursor.state(walk.key), walk.key);
    if (cursor.blocked(walk.key)) {
      const Occupancy state = cursor.state(walk.key);
      return end_in(stop_in(state), state, walk.key);
    }
  }
}

namespace {

// Whether the path reaches `to` before it meets a blocker or passes `to` by.
template <class Time>
bool reaches(Walk<Time> walk, const VoxelKey& to, GridCursor cursor) {
  const auto target = as_array(to);
  std::array<int, 3> left{};
  int total = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    left[i] = (target[i] - walk.key[i]) * walk.step[i];
    if (left[i] < 0 || (walk.step[i] == 0 && target[i] != walk.key[i])) return false;
    total += left[i];
  }
  while (true) {
    const auto a = static_cast<std::size_t>(walk.next_axis());
    if (--left[a] < 0) return false;
    const int before = walk.key[a];
    walk.advance(static_cast<int>(a));
    if (--total == 0) return true;
    cursor.moved(walk.key, before ^ walk.key[a]);
    if (cursor.blocked(walk.key)) return false;
  }
}

}  // namespace

bool walk_visible(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown) {
  const auto from = grid.lattice().key(segment.from), to = grid.lattice().key(segment.to);
  if (!from || !to) return false;
  if (*from == *to) return true;
  const Eigen::Vector3f direction = normalized_as_octomap(segment.to - segment.from);
  return reaches(make_walk(grid.lattice(), segment.from, *from, direction), *to,
                 GridCursor(grid, unknown, *from));
}

bool walk_visible(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown) {
  if (segment.from == segment.to) return true;
  return reaches(make_walk(segment.from, segment.to), segment.to, GridCursor(grid, unknown, segment.from));
}

}  // namespace frontlux::detail
