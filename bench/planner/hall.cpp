#include "planner/hall.hpp"

#include "random.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace frontlux::bench {
namespace {

constexpr float kLength = 80.F, kWidth = 40.F, kHeight = 12.F, kFloor = -0.05F;  // [m]
constexpr float kPi = 3.14159265F;

// Distance at which a ray enters a box, infinity if it does not.
float entry(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  float near = 0.F, far = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 3; ++i) {
    const float a = (box.min()[i] - origin[i]) / direction[i], b = (box.max()[i] - origin[i]) / direction[i];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far ? near : std::numeric_limits<float>::infinity();
}

}  // namespace

Hall::Hall() {
  const auto add = [this](float x, float y, float z, float dx, float dy, float dz) {
    solids_.emplace_back(Eigen::Vector3f(x, y, z), Eigen::Vector3f(x + dx, y + dy, z + dz));
  };
  add(-1, -1, kFloor - 1, kLength + 2, kWidth + 2, 1);
  add(-1, -1, kHeight, kLength + 2, kWidth + 2, 1);
  add(-1, -1, kFloor, 1, kWidth + 2, kHeight + 1);
  add(kLength, -1, kFloor, 1, kWidth + 2, kHeight + 1);
  add(-1, -1, kFloor, kLength + 2, 1, kHeight + 1);
  add(-1, kWidth, kFloor, kLength + 2, 1, kHeight + 1);
  for (float x = 5.F; x < kLength; x += 6.F)
    for (const float y : {3.F, 15.F, 37.F}) add(x, y, kFloor, 0.6F, 0.6F, kHeight);
  for (std::uint64_t i = 0; i < 60; ++i) {  // crates on both sides of the ground robot's way
    const auto draw = [&](std::uint64_t stream, float low, float high) {
      return low + (high - low) * static_cast<float>(uniform(stream, i));
    };
    const float y = i % 2 == 0 ? draw(1, 0.3F, 2.5F) : draw(1, 13.F, 16.F);
    add(draw(2, 0.F, kLength - 3.F), y, kFloor, draw(3, 0.5F, 2.5F), draw(4, 0.5F, 1.5F), draw(5, 0.4F, 3.F));
  }
}

Eigen::AlignedBox3d Hall::bounds() const {
  return {Eigen::Vector3d(-0.3, -0.3, -0.3), Eigen::Vector3d(80.1, 40.2, 12.3)};
}

float Hall::range(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float max_range) const {
  float nearest = std::numeric_limits<float>::infinity();
  for (const auto& solid : solids_) nearest = std::min(nearest, entry(solid, origin, direction));
  return nearest <= max_range ? nearest : std::numeric_limits<float>::infinity();
}

planner::Scan Hall::lidar_scan(const Eigen::Vector3f& origin) const {
  planner::Scan scan{origin, 6.0, {}, {}};
  for (int azimuth = 0; azimuth < 720; ++azimuth)
    for (int beam = 0; beam < 32; ++beam) {
      const float a = 2.F * kPi * (static_cast<float>(azimuth) + 0.5F) / 720.F;
      const float e = kPi / 9.F * (2.F * static_cast<float>(beam) / 31.F - 1.F);
      const Eigen::Vector3f direction(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      scan.directions.push_back(direction);
      scan.ranges.push_back(range(origin, direction, 6.F));
    }
  return scan;
}

planner::Scan Hall::camera_scan(const Eigen::Vector3f& origin, float yaw) const {
  planner::Scan scan{origin, 10.0, {}, {}};
  const float left = std::tan(kPi / 4.F), up = std::tan(kPi / 5.F);
  for (int row = 0; row < 120; ++row)
    for (int column = 0; column < 160; ++column) {
      const float l = left * (1.F - (2.F * static_cast<float>(column) + 1.F) / 160.F);
      const float u = up * (1.F - (2.F * static_cast<float>(row) + 1.F) / 120.F);
      const Eigen::Vector3f direction =
          Eigen::Vector3f(std::cos(yaw) - l * std::sin(yaw), std::sin(yaw) + l * std::cos(yaw), u)
              .normalized();
      scan.directions.push_back(direction);
      scan.ranges.push_back(range(origin, direction, 10.F));
    }
  return scan;
}

}  // namespace frontlux::bench
