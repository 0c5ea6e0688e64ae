#include "packet/single_walk.hpp"

#include "packet/packet_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace frontlux::detail {
namespace {

constexpr std::array kLowBit = {0U, 3U, 6U};  // of each axis in an index

#ifdef __SSE2__
using Time = __m128d;
Time time(double t) { return _mm_set_sd(t); }
#else
using Time = double;
#endif

// The next crossing of a ray with the planes across each axis. No branch depends on which axis is next, and
// where there are vector registers times stay in them.
class NextCrossings {
 public:
  NextCrossings(const Crossings<double>& line, double end)
      : x_(time(line.t_max[0])),
        y_(time(line.t_max[1])),
        z_(time(line.t_max[2])),
        dx_(time(line.t_delta[0])),
        dy_(time(line.t_delta[1])),
        dz_(time(line.t_delta[2])),
        end_(time(end)) {}

  [[nodiscard]] bool is_over() const { return _mm_comigt_sd(_mm_min_sd(_mm_min_sd(x_, y_), z_), end_) != 0; }
  /// How much later than the next crossing the one after it comes, on another axis.
  [[nodiscard]] bool closer_than(const Time& time) const {
    const Time first = _mm_min_sd(x_, y_), last = _mm_max_sd(x_, y_);
    const Time gap = _mm_sub_sd(_mm_max_sd(first, _mm_min_sd(last, z_)), _mm_min_sd(first, z_));
    return _mm_comilt_sd(gap, time) != 0;
  }
  /// @return 0 or 1: z, 2: y, 3: x
  std::size_t take() {
    const Time x_before_y = _mm_cmplt_sd(x_, y_), not_z = _mm_cmplt_sd(_mm_min_sd(x_, y_), z_);
    x_ = _mm_add_sd(x_, _mm_and_pd(_mm_and_pd(not_z, x_before_y), dx_));
    y_ = _mm_add_sd(y_, _mm_and_pd(_mm_andnot_pd(x_before_y, not_z), dy_));
    z_ = _mm_add_sd(z_, _mm_andnot_pd(not_z, dz_));
    return static_cast<std::size_t>(_mm_movemask_pd(_mm_unpacklo_pd(x_before_y, not_z)));
  }
  [[nodiscard]] double at(std::size_t axis) const {
    return _mm_cvtsd_f64(axis == 0 ? x_ : axis == 1 ? y_ : z_);
  }
  void set(std::size_t axis, double t) { (axis == 0 ? x_ : axis == 1 ? y_ : z_) = _mm_set_sd(t); }

 private:
  Time x_, y_, z_, dx_, dy_, dz_, end_;
};

std::uint32_t next_index(std::uint32_t index, std::uint32_t axis) {
  return (((index | ~axis) + 1) & axis) | (index & ~axis);
}
std::array<std::uint32_t, 4> axes_by_choice(const OpenVoxels::Layout& layout) {
  return {layout.bits[2], layout.bits[2], layout.bits[1], layout.bits[0]};
}

// In castRay's own times.
std::uint32_t walk_exactly(const OpenVoxels& table, const TableRay& ray, double length) {
  const auto axes = axes_by_choice(table.layout());
  NextCrossings next(ray.line, length);
  std::uint32_t index = ray.index;
  while (!next.is_over()) {
    index = next_index(index, axes[next.take()]);
    if (!table.open(index ^ ray.flip)) return index ^ ray.flip;
  }
  return kWentThrough;
}

}  // namespace

std::optional<TableRay> enter(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  const auto key = lattice.key(ray.origin);
  if (!key || !table.contains(*key)) return std::nullopt;
  const OpenVoxels::Layout& layout = table.layout();
  const std::uint32_t index = layout.index(*key);
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  if (!table.open(index) || !is_unit(direction)) return std::nullopt;
  TableRay r{*key, direction, crossings_of(lattice, ray.origin, *key, direction), 0, 0};
  for (std::size_t a = 0; a < 3; ++a) r.flip |= r.line.step[a] < 0 ? layout.bits[a] : 0U;
  r.index = index ^ r.flip;
  return r;
}

// Times after a jump are off by some roundings of what castRay has. As long as no two crossings come closer
// than that, the path is the same.
std::uint32_t walk_alone(const OpenVoxels& table, const TableRay& ray, double length) {
  const double too_close = 1e-11 * length;  // castRay's roundings come to 1e-13 in a thousand steps
  const Time close = time(too_close);
  const OpenVoxels::Layout& layout = table.layout();
  const auto axes = axes_by_choice(layout);
  const auto& d = ray.line.t_delta;
  const std::array<double, 3> rate = {1.0 / d[0], 1.0 / d[1], 1.0 / d[2]};
  NextCrossings next(ray.line, length);
  std::uint32_t index = ray.index;
  while (true) {
    if (const std::uint32_t radius = table.radius(index ^ ray.flip); radius > 1) {
      const auto leaves = [&](std::size_t a) {
        return next.at(a) +
               static_cast<double>(static_cast<int>(4 * radius - 1 - (index >> kLowBit[a] & 3U))) * d[a];
      };
      const double end = std::min(std::min(leaves(0), leaves(1)), leaves(2));
      if (end > length) return kWentThrough;
      const double until = end - 4 * too_close;
      double closest = length;
      for (std::size_t a = 0; a < 3; ++a) {
        const int steps = static_cast<int>(std::max((until - next.at(a)) * rate[a] + 1.0, 0.0));
        const double t = next.at(a) + steps * d[a];
        next.set(a, t);
        closest = std::min(closest, std::min(t - until, until - (t - d[a])));
        const auto count = static_cast<std::uint32_t>(steps);
        const std::uint32_t axis = layout.bits[a];
        const std::uint32_t add = (count & 7U) << kLowBit[a] | (count >> 3U) << layout.shift(a);
        index = (((index | ~axis) + add) & axis) | (index & ~axis);
      }
      if (closest < too_close) return walk_exactly(table, ray, length);
    }
    for (int step = 0; step < 4; ++step) {
      if (next.is_over()) return kWentThrough;
      if (next.closer_than(close)) return walk_exactly(table, ray, length);
      index = next_index(index, axes[next.take()]);
      if (!table.open(index ^ ray.flip)) return index ^ ray.flip;
    }
  }
}

}  // namespace frontlux::detail
