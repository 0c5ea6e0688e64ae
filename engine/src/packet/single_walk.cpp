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

// Times stay in vector registers where there are such for single numbers.
#ifdef __SSE2__
using Time = __m128d;
using Mask = __m128d;
Time time(double t) { return _mm_set_sd(t); }
double number(Time t) { return _mm_cvtsd_f64(t); }
Time min(Time a, Time b) { return _mm_min_sd(a, b); }
Time max(Time a, Time b) { return _mm_max_sd(a, b); }
Time add(Time a, Time b) { return _mm_add_sd(a, b); }
Time subtract(Time a, Time b) { return _mm_sub_sd(a, b); }
Mask less(Time a, Time b) { return _mm_cmplt_sd(a, b); }
Mask both(Mask a, Mask b) { return _mm_and_pd(a, b); }
Mask but_not(Mask a, Mask b) { return _mm_andnot_pd(b, a); }
Time only_if(Mask m, Time t) { return _mm_and_pd(m, t); }
Time only_unless(Mask m, Time t) { return _mm_andnot_pd(m, t); }
bool is_less(Time a, Time b) { return _mm_comilt_sd(a, b) != 0; }
std::size_t bits(Mask low, Mask high) {
  return static_cast<std::size_t>(_mm_movemask_pd(_mm_unpacklo_pd(low, high)));
}
#else
using Time = double;
using Mask = bool;
Time time(double t) { return t; }
double number(Time t) { return t; }
Time min(Time a, Time b) { return a < b ? a : b; }
Time max(Time a, Time b) { return a > b ? a : b; }
Time add(Time a, Time b) { return a + b; }
Time subtract(Time a, Time b) { return a - b; }
Mask less(Time a, Time b) { return a < b; }
Mask both(Mask a, Mask b) { return a && b; }
Mask but_not(Mask a, Mask b) { return a && !b; }
Time only_if(Mask m, Time t) { return m ? t : 0.0; }
Time only_unless(Mask m, Time t) { return m ? 0.0 : t; }
bool is_less(Time a, Time b) { return a < b; }
std::size_t bits(Mask low, Mask high) { return (low ? 1U : 0U) | (high ? 2U : 0U); }
#endif

// The next crossing of a ray with the planes across each axis. No branch depends on which axis is next.
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

  [[nodiscard]] bool is_over() const { return is_less(end_, min(min(x_, y_), z_)); }
  /// Whether between the next crossing and the one after it, on another axis, there is less than a time.
  [[nodiscard]] bool closer_than(const Time& time) const {
    const Time first = min(x_, y_), last = max(x_, y_);
    return is_less(subtract(max(first, min(last, z_)), min(first, z_)), time);
  }
  /// @return 0 or 1: z, 2: y, 3: x
  std::size_t take() {
    const Mask x_before_y = less(x_, y_), not_z = less(min(x_, y_), z_);
    x_ = add(x_, only_if(both(not_z, x_before_y), dx_));
    y_ = add(y_, only_if(but_not(not_z, x_before_y), dy_));
    z_ = add(z_, only_unless(not_z, dz_));
    return bits(x_before_y, not_z);
  }
  [[nodiscard]] double at(std::size_t axis) const { return number(axis == 0 ? x_ : axis == 1 ? y_ : z_); }
  void set(std::size_t axis, double t) { (axis == 0 ? x_ : axis == 1 ? y_ : z_) = time(t); }

 private:
  Time x_, y_, z_, dx_, dy_, dz_, end_;
};

// What is added below an axis' bits carries up to them.
std::uint32_t advanced(std::uint32_t index, std::uint32_t axis, std::uint32_t steps) {
  return (((index | ~axis) + steps) & axis) | (index & ~axis);
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
    index = advanced(index, axes[next.take()], 1);
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
        index =
            advanced(index, layout.bits[a], (count & 7U) << kLowBit[a] | (count >> 3U) << layout.shift(a));
      }
      if (closest < too_close) return walk_exactly(table, ray, length);
    }
    for (int step = 0; step < 4; ++step) {
      if (next.is_over()) return kWentThrough;
      if (next.closer_than(close)) return walk_exactly(table, ray, length);
      index = advanced(index, axes[next.take()], 1);
      if (!table.open(index ^ ray.flip)) return index ^ ray.flip;
    }
  }
}

}  // namespace frontlux::detail
