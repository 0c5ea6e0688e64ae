#include "assignment/feasible_region.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>

namespace frontlux::planner::detail {
namespace {

constexpr double kMaxReach = 4096;  // [voxels]

int checked_reach(const FieldOfView& view, double resolution) {
  view.check();
  const double reach = view.max_range / resolution;
  if (!(reach <= kMaxReach))
    throw std::invalid_argument("field of view: max_range is " + std::to_string(view.max_range) +
                                " m, but at most " + std::to_string(static_cast<int>(kMaxReach)) +
                                " voxels of " + std::to_string(resolution) + " m are possible");
  return static_cast<int>(reach) + 1;
}

// Least and greatest distance between two ranges.
std::pair<int, int> distances(int low, int high, int other_low, int other_high) {
  return {std::max({other_low - high, low - other_high, 0}), std::max(other_high - low, high - other_low)};
}

}  // namespace

FeasibleRegion::FeasibleRegion(const FieldOfView& view, double resolution)
    : reach_(checked_reach(view, resolution)) {
  heights_.reserve(static_cast<std::size_t>(reach_ + 1) * static_cast<std::size_t>(reach_ + 1));
  const auto in_view = [&](int x, int y, int z) {
    return view.contains_at_some_yaw(Eigen::Vector3d(x, y, z) * resolution);
  };
  for (int x = 0; x <= reach_; ++x)
    for (int y = 0; y <= reach_; ++y) {
      int low = -1, high = reach_ + 1;  // both conditions, range and elevation, fail from some height on
      if (x == 0 && y == 0) high = 0;   // right above and below only a view of half a turn would reach
      while (high - low > 1) {
        const int middle = (low + high) / 2;
        (in_view(x, y, middle) ? low : high) = middle;
      }
      heights_.push_back(low);
      if (low < 0) continue;
      squared_range_ = std::max(squared_range_, static_cast<double>(x * x + y * y + low * low));
      greatest_height_ = std::max(greatest_height_, low);
      slope_ = std::max(slope_, low / std::hypot(x, y));
    }
}

bool FeasibleRegion::may_meet(const KeyBox& from, const KeyBox& to) const {
  const auto [x, far_x] = distances(from.min.x, from.max.x, to.min.x, to.max.x);
  const auto [y, far_y] = distances(from.min.y, from.max.y, to.min.y, to.max.y);
  const auto [z, far_z] = distances(from.min.z, from.max.z, to.min.z, to.max.z);
  const double squared = static_cast<double>(x) * x + static_cast<double>(y) * y + static_cast<double>(z) * z;
  if (squared > squared_range_) return false;
  const double across = static_cast<double>(far_x) * far_x + static_cast<double>(far_y) * far_y;
  return static_cast<double>(z) * z <= slope_ * slope_ * across * (1.0 + 1e-9);
}

std::vector<std::array<int, 3>> FeasibleRegion::offsets(int length) const {
  const auto squared = [](const std::array<int, 3>& o) { return o[0] * o[0] + o[1] * o[1] + o[2] * o[2]; };
  std::vector<std::array<int, 3>> offsets;
  for (int x = -length; x <= length; ++x)
    for (int y = -length; y <= length; ++y)
      for (int z = -length; z <= length; ++z)
        if (squared({x, y, z}) <= length * length && contains(x, y, z)) offsets.push_back({x, y, z});
  std::sort(offsets.begin(), offsets.end(), [&](const auto& a, const auto& b) {
    return std::tuple(squared(a), a) < std::tuple(squared(b), b);
  });
  return offsets;
}

// Points of a rank-1 lattice in the box around the region: spread evenly, without a pattern along an axis.
std::vector<std::array<int, 3>> FeasibleRegion::spread_offsets(std::size_t count) const {
  const std::array<int, 3> reach = {reach_, reach_, std::max(greatest_height_, 1)};
  constexpr std::array<double, 3> kStep = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  std::vector<std::array<int, 3>> offsets;
  for (std::size_t i = 0; offsets.size() < count && i < 16 * count; ++i) {
    std::array<int, 3> o{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = 0.5 + static_cast<double>(i) * kStep[a];
      o[a] = static_cast<int>(std::lround((2.0 * (at - std::floor(at)) - 1.0) * reach[a]));
    }
    if (contains(o[0], o[1], o[2])) offsets.push_back(o);
  }
  return offsets;
}

}  // namespace frontlux::planner::detail
