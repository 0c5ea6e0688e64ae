#include "sensing/keyed_random.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/sensor_rays.hpp>
#include <frontlux/sim/sensor.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::sim {
namespace {

// Between 0 and 1, neither of them included.
double open_unit(SplitMix64& random) { return (static_cast<double>(random.bits() >> 12) + 0.5) * 0x1p-52; }

// Of mean 0 and deviation 1 (Box and Muller).
double normal(SplitMix64& random) {
  const double radius = std::sqrt(-2.0 * std::log(open_unit(random)));
  return radius * std::cos(2.0 * std::numbers::pi * open_unit(random));
}

}  // namespace

Sensor::Sensor(const FieldOfView& field_of_view, std::size_t columns, std::size_t rows, RangeErrors errors)
    : field_of_view_(field_of_view),
      errors_(errors),
      directions_(sensor_directions(field_of_view, columns, rows)) {
  for (const auto& [name, value] : {std::pair("sigma", errors.sigma), {"growth", errors.growth}})
    if (!(value >= 0.0 && std::isfinite(value)))
      throw std::invalid_argument(std::string("sensor: ") + name + " is " + std::to_string(value) +
                                  ", but has to be 0 or more");
  for (const auto& [name, value] : {std::pair("dropout", errors.dropout), {"stray", errors.stray}})
    if (!(value >= 0.0 && value <= 1.0))
      throw std::invalid_argument(std::string("sensor: ") + name + " is " + std::to_string(value) +
                                  ", but has to be a probability");
}

Sensor sensor_of(const planner::RobotDescription& robot, RangeErrors errors) {
  return {robot.robot.view, robot.columns, robot.rows, errors};
}

planner::Scan sense(const Surface& surface, const Sensor& sensor, const planner::Pose& sensor_pose,
                    std::uint64_t seed) {
  const Eigen::Vector3f origin = sensor_pose.position.cast<float>();
  if (!origin.allFinite() || !std::isfinite(sensor_pose.yaw))
    throw std::invalid_argument("sensor: its pose is not finite");
  const std::size_t count = sensor.directions().size();
  const double max_range = sensor.field_of_view().max_range;
  planner::Scan scan{origin, max_range, std::vector<Eigen::Vector3f>(count), std::vector<float>(count)};

  const double c = std::cos(sensor_pose.yaw), s = std::sin(sensor_pose.yaw);
  std::vector<Surface::Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& d = sensor.directions()[i];
    scan.directions[i] = Eigen::Vector3d(c * d.x() - s * d.y(), s * d.x() + c * d.y(), d.z()).cast<float>();
    rays[i] = {origin, scan.directions[i], max_range};
  }
  std::vector<Surface::Hit> hits(count);
  surface.cast(rays, hits);

  const RangeErrors& errors = sensor.errors();
  const auto measured = [&](std::size_t i) {
    SplitMix64 random = random_of(seed, i);
    if (open_unit(random) < errors.dropout) return std::numeric_limits<double>::quiet_NaN();
    const double range = hits[i].range;
    if (errors.stray > 0.0 && open_unit(random) < errors.stray)
      return open_unit(random) * std::min(range, max_range);
    const double sigma = errors.sigma + errors.growth * range * range;
    if (sigma == 0.0 || hits[i].triangle == Surface::kNone) return range;
    return std::clamp(range + sigma * normal(random), 0.0, max_range);
  };
  constexpr std::size_t kChunk = 1024;
  for_each_chunk(count, kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) scan.ranges[i] = static_cast<float>(measured(i));
  });
  return scan;
}

}  // namespace frontlux::sim
