#pragma once

#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

/// Skips cubes of one state: where a path is after thousands of steps, without taking each step. Every time
/// is exact to the last bit, so that a walk can go on from there.
namespace frontlux::detail {

/// `t` after `count` additions of `delta`, each rounded as a loop would round it. Between two powers of two
/// all results are multiples of one unit, and every addition there adds the same multiple: `delta` rounded to
/// one. (If `delta` lies in the middle between two, the even result is taken, and from an even result the
/// same step always leads to an even one. So the increment of the *second* addition is the one that all later
/// ones have.)
/// @param delta  not negative
inline double after_additions(double t, double delta, int count) {
  while (count > 0) {
    const double first = t + delta;
    if (count >= 4 && first >= std::numeric_limits<double>::min() && first < 1e300) {
      constexpr std::uint64_t kExponent = std::uint64_t{0x7FF} << 52;
      const auto binade = std::bit_cast<double>(std::bit_cast<std::uint64_t>(first) & kExponent);
      const double top = 2.0 * binade;
      const double second = first + delta, third = second + delta;
      if (third < top && third > second) {
        const double increment = third - second;  // exact, as are the product and the sum below: units
        const double room = (top - second) / increment - 1.0;
        const int more = static_cast<int>(std::min(static_cast<double>(count - 2), room));
        t = second + more * increment;
        count -= 2 + more;
        continue;
      }
    }
    t = first;
    --count;
  }
  return t;
}
inline std::int64_t after_additions(std::int64_t t, std::int64_t delta, int count) {
  return t + count * delta;
}

/// Where a path is: its voxel, the crossings to come, and per axis how many more steps it may take.
template <class Time>
struct PathState {
  VoxelKey key;
  Crossings<Time> line;
  std::array<int, 3> steps_left;
};

/// What `skip_cube` did.
enum class CubeSkip : std::uint8_t {
  kNone,     ///< nothing: walk on voxel by voxel
  kSkipped,  ///< the path is in the first voxel outside the cube
  kOverstep  ///< the last step was one more than the path may take along an axis: that axis has -1 left
};

/// Moves on to the first voxel outside the cube of 2^log2_edge voxels a side that holds `at.key`, or to the
/// first step too many.
/// @param until  does nothing if the last step would come at this time or later
template <class Time>
CubeSkip skip_cube(PathState<Time>& at, int log2_edge, Time until) {
  Crossings<Time>& line = at.line;
  auto key = as_array(at.key);
  const int edge = 1 << log2_edge;
  // The path leaves the cube along the axis that ends first. Ties go to z before y before x (rule 5).
  std::array<int, 3> steps_to_end{};
  std::size_t axis = 3;
  Time end{};
  for (std::size_t i = 3; i-- > 0;) {
    if (line.step[i] == 0) continue;
    const int inside = key[i] & (edge - 1);
    steps_to_end[i] = std::min(line.step[i] > 0 ? edge - inside : inside + 1, at.steps_left[i] + 1);
    const Time t = after_additions(line.t_max[i], line.t_delta[i], steps_to_end[i] - 1);
    if (axis == 3 || t < end) {
      axis = i;
      end = t;
    }
  }
  if (axis == 3 || !(end < until)) return CubeSkip::kNone;

  std::array<int, 3> steps{};
  std::array<Time, 3> t_max = line.t_max;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == axis) {
      steps[i] = steps_to_end[i];
      t_max[i] = end + line.t_delta[i];
      continue;
    }
    if (line.step[i] == 0) continue;
    const auto comes_first = [&](Time t) { return t < end || (t == end && i > axis); };
    // The estimate can be wrong by one; two less is surely not too many.
    const Time estimate = (end - t_max[i]) / line.t_delta[i];
    if (estimate > Time{4}) {
      const int sure = static_cast<int>(std::min(estimate, static_cast<Time>(steps_to_end[i]))) - 2;
      const Time last = after_additions(t_max[i], line.t_delta[i], sure - 1);
      if (!comes_first(last)) return CubeSkip::kNone;
      t_max[i] = last + line.t_delta[i];
      steps[i] = sure;
    }
    while (comes_first(t_max[i])) {
      t_max[i] += line.t_delta[i];
      ++steps[i];
    }
  }
  line.t_max = t_max;
  for (std::size_t i = 0; i < 3; ++i) {
    key[i] += line.step[i] * steps[i];
    at.steps_left[i] -= steps[i];
  }
  if (at.steps_left[axis] < 0) return CubeSkip::kOverstep;  // `key` may lie beyond the key range
  at.key = as_key(key);
  return CubeSkip::kSkipped;
}

}  // namespace frontlux::detail
