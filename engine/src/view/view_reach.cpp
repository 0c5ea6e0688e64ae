#include "view/view_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <string>

namespace frontlux::detail {
namespace {

constexpr double kSafely = 1.0 + 1e-9;  // far more than rounding can do

int checked_cells(const FieldOfView& field_of_view, double resolution) {
  field_of_view.check();
  const double range = field_of_view.max_range;
  if (!std::isnormal(resolution * resolution) || !std::isnormal(range * range))
    throw std::invalid_argument("view quality: a range of " + std::to_string(range) +
                                " m at a resolution of " + std::to_string(resolution) +
                                " m is out of the numbers' range");
  if (range / resolution > ViewReach::kMaxCells)
    throw std::invalid_argument("view quality: max_range is " + std::to_string(range) + " m, which is " +
                                std::to_string(range / resolution) + " voxels of " +
                                std::to_string(resolution) + " m, but has to be at most " +
                                std::to_string(ViewReach::kMaxCells));
  return static_cast<int>(range / resolution);
}

}  // namespace

ViewReach::ViewReach(const FieldOfView& field_of_view, double resolution, int azimuth_bins)
    : radius_(checked_cells(field_of_view, resolution) + 1 + kMargin) {
  const bool cone = field_of_view.shape == FieldOfView::Shape::kCone;
  const double slope = std::tan((cone ? field_of_view.horizontal : field_of_view.vertical) / 2);
  const double range = field_of_view.max_range / resolution;
  range_squared_ = range * range * kSafely;
  slope_squared_ = slope * slope * kSafely;

  const auto in_view = [&](int dx, int dy, int dz) {
    return field_of_view.contains_at_some_yaw({dx * resolution, dy * resolution, dz * resolution});
  };
  const auto height = [&](int dx, int dy) {
    const double across = dx * dx + dy * dy;
    if (across > range_squared_) return -1;
    const double guess =
        std::min(std::sqrt(std::max(range * range - across, 0.0)), slope * std::sqrt(across));
    int dz = static_cast<int>(guess);
    while (in_view(dx, dy, dz + 1)) ++dz;
    while (dz >= 0 && !in_view(dx, dy, dz)) --dz;
    return dz;
  };
  const auto size = static_cast<std::size_t>(2 * radius_ + 1);
  heights_.assign(size * size, -1);
  const int cells = radius_ - kMargin;
  // The sign of an offset changes no digit of the answer, so a quarter is asked about.
  for (int dx = 0; dx <= cells; ++dx)
    for (int dy = 0; dy <= cells; ++dy) {
      const auto known = static_cast<std::int16_t>(height(dx, dy));
      for (const int x : {-dx, dx})
        for (const int y : {-dy, dy}) heights_[static_cast<std::size_t>(middle() + entry(x, y))] = known;
    }

  if (azimuth_bins == 0) return;
  bins_.assign(size * size, 0);
  for (int dx = -cells; dx <= cells; ++dx)
    for (int dy = -cells; dy <= cells; ++dy)
      bins_[static_cast<std::size_t>(middle() + entry(dx, dy))] =
          static_cast<std::uint16_t>(azimuth_bin(std::atan2(dy, dx), azimuth_bins));
}

bool ViewReach::contains(const VoxelKey& from, const VoxelKey& to) const {
  const int dx = to.x - from.x, dy = to.y - from.y, dz = to.z - from.z;
  if (std::abs(dx) > radius_ || std::abs(dy) > radius_) return false;
  return std::abs(dz) <= heights()[entry(dx, dy)];
}

bool ViewReach::may_contain(const CellBox& from, const CellBox& to) const {
  std::array<double, 3> near{}, far{};
  for (std::size_t a = 0; a < 3; ++a) {
    near[a] = std::max({0, to.min[a] - from.max[a], from.min[a] - to.max[a]});
    far[a] = std::max(to.max[a] - from.min[a], from.max[a] - to.min[a]);
  }
  const double across = std::min(far[0] * far[0] + far[1] * far[1], range_squared_);
  return near[0] * near[0] + near[1] * near[1] + near[2] * near[2] <= range_squared_ &&
         near[2] * near[2] <= slope_squared_ * across;
}

int azimuth_bin(double azimuth, int count) {
  const double turns = azimuth / (2 * std::numbers::pi);
  const double part = turns - std::floor(turns);  // may round up to 1
  return std::min(static_cast<int>(part * count), count - 1);
}

}  // namespace frontlux::detail
