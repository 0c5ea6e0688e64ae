#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace frontlux::test {

/// When a ray enters a box that is grown by `by` on all sides (shrunk, if that is negative), in long double;
/// none if it misses the box between t_near and t_far. All numbers are taken as exact.
inline std::optional<long double> entry_time(const float (&center)[3], const float (&half)[3], long double by,
                                             const float (&origin)[3], const float (&direction)[3],
                                             float t_near, float t_far) {
  long double in = t_near, out = t_far;
  for (std::size_t i = 0; i < 3; ++i) {
    const long double reach = half[i] + by, offset = static_cast<long double>(center[i]) - origin[i];
    if (reach < 0.0L) return std::nullopt;
    if (direction[i] == 0.0F) {
      if (std::fabs(offset) > reach) return std::nullopt;
      continue;
    }
    const long double a = (offset - reach) / direction[i], b = (offset + reach) / direction[i];
    in = std::max(in, std::min(a, b));
    out = std::min(out, std::max(a, b));
  }
  return in <= out ? std::optional(in) : std::nullopt;
}

}  // namespace frontlux::test
