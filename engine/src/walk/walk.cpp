#include "walk/walk.hpp"

#include "walk/grid_path.hpp"

#include <cmath>
#include <optional>
#include <type_traits>

#ifdef __FAST_MATH__
#error "castRay is answered bit for bit: compile frontlux without -ffast-math (cmake/FrontluxTarget.cmake)"
#endif

namespace frontlux::detail {
namespace {

// A direction as castRay walks along it: a component that is not a number acts as 0, and so does every finite
// one beside an infinite one.
Eigen::Vector3d unit_vector(const Eigen::Vector3f& direction) {
  Eigen::Array3d d = direction.cast<double>().array();
  d = d.isNaN().select(0.0, d);
  if (d.isInf().any()) d = d.isInf().select(d.sign(), 0.0);
  return d.matrix().normalized();
}

}  // namespace

void make_hit(const Lattice& lattice, const Ray& ray, const VoxelKey& origin_key,
              const Eigen::Vector3f& direction, RayStop stop, Occupancy state, const VoxelKey& key,
              Hit& hit) {
  hit = {stop, state, key, lattice.center(key), ray.origin, 0.0F};
  if (key == origin_key) return;
  // Only a direction that castRay could not normalise needs care.
  const Eigen::Vector3d d = is_unit(direction) ? direction.cast<double>() : unit_vector(direction);
  const Eigen::Vector3d origin = ray.origin.cast<double>();
  const std::array<int, 3> cell = as_array(key);
  double time = 0.0;  // of the last crossing into the voxel, in units of d's length
  for (int i = 0; i < 3; ++i) {
    const int face = cell[static_cast<std::size_t>(i)] - Lattice::kOrigin + static_cast<int>(d[i] < 0.0);
    const double crossing = (face * lattice.resolution() - origin[i]) / d[i];
    time = d[i] != 0.0 && crossing > time ? crossing : time;
  }
  hit.entry = (origin + time * d).cast<float>();
  // In this order, as packets do: where the product is in the middle between two floats it decides.
  const double length = std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z());
  hit.distance = static_cast<float>(time * length);
}

Hit walk_ray(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown) {
  const Lattice& lattice = grid.lattice();
  const auto start = lattice.key(ray.origin);
  if (!start) return {};
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  const auto end_in = [&](RayStop stop, Occupancy state, const VoxelKey& key) {
    Hit hit;
    make_hit(lattice, ray, *start, direction, stop, state, key, hit);
    return hit;
  };

  const Occupancy origin_state = grid.at(*start);
  if (blocks(origin_state, unknown)) return end_in(stop_in(origin_state), origin_state, *start);
  const Crossings<double> line = crossings_of(lattice, ray.origin, *start, direction);
  if (line.none()) return {};

  GridPath<double> path(grid, unknown, *start, line, steps_to_border(line, *start));
  const double range_matters_from = time_surely_in_range(ray.max_range, lattice.resolution(), direction);
  while (true) {
    const double t = path.advance();
    if (path.overstepped()) break;
    path.fetch_brick();
    if (t >= range_matters_from && out_of_range(ray.origin, lattice.center(path.key()), ray.max_range))
      return end_in(RayStop::kOutOfRange, path.state(), path.key());
    if (path.blocked()) return end_in(stop_in(path.state()), path.state(), path.key());
  }
  const VoxelKey last = path.key_before_overstep();
  return end_in(RayStop::kLeftMap, grid.at(last), last);
}

namespace {

// How many steps `to` lies ahead of `from` on a line, per axis; none if it lies behind.
template <class Time>
std::optional<std::array<int, 3>> steps_to(const Crossings<Time>& line, const VoxelKey& from,
                                           const VoxelKey& to) {
  const auto a = as_array(from), b = as_array(to);
  std::array<int, 3> steps{};
  for (std::size_t i = 0; i < 3; ++i) {
    steps[i] = (b[i] - a[i]) * line.step[i];
    if (steps[i] < 0 || (line.step[i] == 0 && a[i] != b[i])) return std::nullopt;
  }
  return steps;
}

// Whether the path reaches `to` before it meets a blocker or misses `to`.
template <bool kBack = false, class Time>
bool reaches(const VoxelGrid& grid, UnknownPolicy unknown, const Crossings<Time>& line, const VoxelKey& from,
             const VoxelKey& to) {
  const auto steps = steps_to(line, from, to);
  if (!steps) return false;
  GridPath<Time, kBack> path(grid, unknown, from, line, *steps);
  while (true) {
    path.advance();
    if (path.exhausted()) return true;
    if constexpr (std::is_same_v<Time, double>)
      if (path.overstepped()) return false;
    path.fetch_brick();
    if (path.blocked()) return false;
  }
}

}  // namespace

bool walk_visible(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown) {
  const auto from = grid.lattice().key(segment.from), to = grid.lattice().key(segment.to);
  if (!from || !to) return false;
  if (*from == *to) return true;
  const Eigen::Vector3f direction = normalized_as_octomap(segment.to - segment.from);
  return reaches(grid, unknown, crossings_of(grid.lattice(), segment.from, *from, direction), *from, *to);
}

bool walk_visible(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown) {
  if (segment.from == segment.to) return true;
  // Back, since a blocker is mostly near what is to be seen.
  return reaches<true>(grid, unknown, crossings_of(segment.to, segment.from), segment.to, segment.from);
}

}  // namespace frontlux::detail
