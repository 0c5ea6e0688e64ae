#include "assignment/view_offsets.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace frontlux::planner::detail {

std::vector<std::array<int, 3>> nearby_offsets(const ViewRegion& view, int length) {
  const auto squared = [](const std::array<int, 3>& o) { return o[0] * o[0] + o[1] * o[1] + o[2] * o[2]; };
  std::vector<std::array<int, 3>> offsets;
  for (int x = -length; x <= length; ++x)
    for (int y = -length; y <= length; ++y)
      for (int z = -length; z <= length; ++z)
        if (squared({x, y, z}) <= length * length && view.contains(x, y, z)) offsets.push_back({x, y, z});
  std::sort(offsets.begin(), offsets.end(), [&](const auto& a, const auto& b) {
    return std::tuple(squared(a), a) < std::tuple(squared(b), b);
  });
  return offsets;
}

// Points of a rank-1 lattice in the box around the view: spread evenly, without a pattern along an axis.
std::vector<std::array<int, 3>> spread_offsets(const ViewRegion& view, std::size_t count) {
  const std::array<int, 3> reach = {view.reach(), view.reach(), std::max(view.greatest_height(), 1)};
  constexpr std::array<double, 3> kStep = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  std::vector<std::array<int, 3>> offsets;
  for (std::size_t i = 0; offsets.size() < count && i < 16 * count; ++i) {
    std::array<int, 3> o{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = 0.5 + static_cast<double>(i) * kStep[a];
      o[a] = static_cast<int>(std::lround((2.0 * (at - std::floor(at)) - 1.0) * reach[a]));
    }
    if (view.contains(o[0], o[1], o[2])) offsets.push_back(o);
  }
  return offsets;
}

}  // namespace frontlux::planner::detail
