#include "packet/single_walk.hpp"

#include "packet/packet_walk.hpp"
#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace frontlux::detail {
namespace {

constexpr std::array kLowBit = {0U, 3U, 6U};  // of each axis in an index

// A number for each axis, and a fourth one that means nothing. Times are whole numbers, as in packets.
using PerAxis [[gnu::vector_size(16)]] = std::int32_t;
// The end of a ray's time. Four crossings behind it still fit into 31 bits, though their times mean nothing.
constexpr std::int32_t kEndOfTime = (1 << 28) - 1;
constexpr std::int32_t kNever = 7 * (1 << 28);  // later than those, and `too_close` can be added

// What is added below an axis' bits carries up to them.
std::uint32_t advanced(std::uint32_t index, std::uint32_t axis, std::uint32_t steps) {
  return (((index | ~axis) + steps) & axis) | (index & ~axis);
}

// A ray in an open voxel of a table.
struct TableRay {
  Crossings<double> line;
  std::uint32_t index;  // of that voxel in the table, flipped so that every step adds
  std::uint32_t flip;   // the bits of all axes along which it descends
};

// In castRay's own times.
std::uint32_t walk_exactly(const OpenVoxels& table, const TableRay& ray, double length) {
  std::array<double, 3> t = ray.line.t_max;
  std::uint32_t index = ray.index;
  while (true) {
    // Ties go to z before y before x (rule 5).
    const std::size_t across = t[0] < t[1] ? 0 : 1, axis = t[across] < t[2] ? across : 2;
    if (t[axis] > length) return kWentThrough;
    t[axis] += ray.line.t_delta[axis];
    index = advanced(index, table.layout().bits[axis], 1);
    if (!table.open(index ^ ray.flip)) return index ^ ray.flip;
  }
}

// @return what `LoneWalk::stopped_at` is
std::uint32_t walk(const OpenVoxels& table, const TableRay& ray, double length) {
  const OpenVoxels::Layout& layout = table.layout();
  const std::array<double, 3>& between = ray.line.t_delta;
  const double units = kEndOfTime / length;
  // Times are cut off to whole numbers, and so is what each step adds: after n steps along an axis the
  // difference of two is off by up to n + 1.
  const int too_close = static_cast<int>(length / std::min(std::min(between[0], between[1]), between[2])) + 4;
  PerAxis t{kNever, kNever, kNever, kNever}, d{}, others{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.line.t_max[a] < 0.0) return walk_exactly(table, ray, length);  // by rounding, on a face
    t[a] = static_cast<std::int32_t>(std::min<double>(ray.line.t_max[a] * units, kNever));
    d[a] = static_cast<std::int32_t>(std::min<double>(between[a] * units, kEndOfTime + 1));
    others[a] = static_cast<std::int32_t>(~layout.bits[a]);
  }
  others[3] = ~(others[0] & others[1] & others[2]);
  std::uint32_t index = ray.index;
  while (true) {
    if (const std::uint32_t radius = table.radius(index ^ ray.flip); radius > 1) {
      const auto leaves = [&](std::size_t a) {
        const auto steps = static_cast<int>(4 * radius - 1 - (index >> kLowBit[a] & 3U));
        return t[a] + steps * static_cast<std::int64_t>(d[a]);
      };
      const std::int64_t end = std::min(std::min(leaves(0), leaves(1)), leaves(2));
      if (end > kEndOfTime) return kWentThrough;
      const int until = static_cast<int>(end) - 4 * too_close;
      int closest = kNever;
      for (std::size_t a = 0; a < 3; ++a) {
        const int steps = t[a] > until ? 0 : (until - t[a]) / d[a] + 1;
        if (steps > 0) closest = std::min(closest, (until - t[a]) % d[a]);
        t[a] += steps * d[a];
        closest = std::min(closest, t[a] - until);
        const auto count = static_cast<std::uint32_t>(steps);
        index =
            advanced(index, layout.bits[a], (count & 7U) << kLowBit[a] | (count >> 3U) << layout.shift(a));
      }
      if (closest < too_close) return walk_exactly(table, ray, length);
    }
    // No branch depends on which axis is next. `along` is the index, with the bits of all other axes set.
    PerAxis along = static_cast<std::int32_t>(index) | others;
    PerAxis surely_over = t + too_close;
    for (int step = 0; step < 4; ++step) {
      const PerAxis one = __builtin_shufflevector(t, t, 1, 2, 0, 3),
                    other = __builtin_shufflevector(t, t, 2, 0, 1, 3);
      const PerAxis first = (one > surely_over) & (other > surely_over), ahead = d & first;
      t += ahead;
      surely_over += ahead;
      along = (along - first) | others;
      PerAxis all = along & __builtin_shufflevector(along, along, 2, 3, 0, 1);
      all &= __builtin_shufflevector(all, all, 1, 0, 3, 2);
      const auto next = static_cast<std::uint32_t>(all[0]);
      if (next == index) return walk_exactly(table, ray, length);  // none was surely first
      index = next;
      if (table.open(index ^ ray.flip)) continue;
      const PerAxis entered = (t - d) & first;  // when, on the axis that it was
      return (entered[0] | entered[1] | entered[2]) > kEndOfTime ? kWentThrough : index ^ ray.flip;
    }
    if (std::min(std::min(t[0], t[1]), t[2]) > kEndOfTime) return kWentThrough;
  }
}

}  // namespace

LoneWalk walk_alone(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  const auto start = lattice.key(ray.origin);
  if (!start || !table.contains(*start)) return {kNeverStarted, {}, {}};
  const OpenVoxels::Layout& layout = table.layout();
  const std::uint32_t index = layout.index(*start);
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  if (!table.open(index) || !is_unit(direction)) return {kNeverStarted, {}, {}};
  TableRay r{crossings_of(lattice, ray.origin, *start, direction), 0, 0};
  for (std::size_t a = 0; a < 3; ++a) r.flip |= r.line.step[a] < 0 ? layout.bits[a] : 0U;
  r.index = index ^ r.flip;
  return {walk(table, r, walked_length(ray.max_range, lattice.resolution())), *start, direction};
}

}  // namespace frontlux::detail
