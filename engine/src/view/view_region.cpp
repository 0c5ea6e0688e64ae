#include <frontlux/file.hpp>
#include <frontlux/view_region.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

constexpr double kSafely = 1.0 + 1e-9;  // far more than rounding can do

int checked_reach(const FieldOfView& view, double resolution) {
  view.check();
  const double range = view.max_range;
  if (!(resolution > 0.0))
    throw std::invalid_argument("field of view: the resolution is " + decimals_of(resolution) +
                                " m, but has to be positive");
  if (!std::isnormal(resolution * resolution) || !std::isnormal(range * range))
    throw std::invalid_argument("field of view: a range of " + decimals_of(range) + " m at a resolution of " +
                                decimals_of(resolution) + " m is out of the numbers' range");
  if (range / resolution > ViewRegion::kMaxRange)
    throw std::invalid_argument("field of view: max_range is " + std::to_string(range) + " m, which is " +
                                std::to_string(range / resolution) + " voxels of " +
                                std::to_string(resolution) + " m, but has to be at most " +
                                std::to_string(ViewRegion::kMaxRange));
  return static_cast<int>(range / resolution) + 1;
}

}  // namespace

ViewRegion::ViewRegion(const FieldOfView& view, double resolution) : reach_(checked_reach(view, resolution)) {
  const double range = view.max_range / resolution, slope = view.slope();
  const double squared_range = range * range * kSafely;
  points_ = {squared_range, slope * slope * kSafely, squared_range};
  const auto in_view = [&](int dx, int dy, int dz) {
    return view.contains_at_some_yaw({dx * resolution, dy * resolution, dz * resolution});
  };
  // Range and elevation are both monotone in the height, in floating point as well.
  const auto greatest = [&](int dx, int dy) {
    const double across = dx * dx + dy * dy;
    if (across > squared_range) return -1;
    int dz = static_cast<int>(
        std::min(std::sqrt(std::max(range * range - across, 0.0)), slope * std::sqrt(across)));
    while (in_view(dx, dy, dz + 1)) ++dz;
    while (dz >= 0 && !in_view(dx, dy, dz)) --dz;
    return dz;
  };
  const auto size = static_cast<std::size_t>(2 * (reach_ + kMargin) + 1);
  heights_.assign(size * size, -1);
  std::int16_t* const middle = heights_.data() + heights_.size() / 2;
  // The sign of an offset changes no digit of the answer: one quarter holds all heights.
  for (int dx = 0; dx <= reach_; ++dx)
    for (int dy = 0; dy <= reach_; ++dy) {
      const int dz = greatest(dx, dy);
      if (dz < 0) continue;
      for (const int x : {-dx, dx})
        for (const int y : {-dy, dy}) middle[entry(x, y)] = static_cast<std::int16_t>(dz);
      greatest_height_ = std::max(greatest_height_, dz);
      slope_ = std::max(slope_, dz / std::hypot(dx, dy));
      voxels_.squared_range =
          std::max(voxels_.squared_range, static_cast<double>(dx * dx + dy * dy + dz * dz));
    }
  voxels_.squared_slope = slope_ * slope_ * kSafely;
  voxels_.squared_width = std::numeric_limits<double>::infinity();
}

bool ViewRegion::Bounds::may_contain(const KeyBox& from, const KeyBox& to) const {
  const auto square = [](int length) { return static_cast<double>(length) * length; };
  const auto nearest = [](int low, int high, int other_low, int other_high) {
    return std::max({0, other_low - high, low - other_high});
  };
  const auto farthest = [](int low, int high, int other_low, int other_high) {
    return std::max(other_high - low, high - other_low);
  };
  const double up = square(nearest(from.min.z, from.max.z, to.min.z, to.max.z));
  const double near = square(nearest(from.min.x, from.max.x, to.min.x, to.max.x)) +
                      square(nearest(from.min.y, from.max.y, to.min.y, to.max.y)) + up;
  const double far = square(farthest(from.min.x, from.max.x, to.min.x, to.max.x)) +
                     square(farthest(from.min.y, from.max.y, to.min.y, to.max.y));
  return near <= squared_range && up <= squared_slope * std::min(far, squared_width);
}

}  // namespace frontlux
