#pragma once

#include <frontlux/field_of_view.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/scan.hpp>
#include <frontlux/sim/surface.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::sim {

/// Errors of a range sensor; none by default.
struct RangeErrors {
  double sigma = 0.0;    ///< [m] standard deviation of the Gaussian noise on a range
  double dropout = 0.0;  ///< probability that a ray gives no measurement
  double stray = 0.0;    ///< probability that a ray returns from nowhere, as from dust: before any surface
  /// [1/m] What sigma grows by with the square of the range, as of depth cameras.
  double growth = 0.0;
};

/// A range sensor: its field of view, the rays that fill it, and its errors.
class Sensor {
 public:
  /// Rays: `sensor_directions`.
  /// @throws std::invalid_argument naming the value, if the field of view does not pass its `check`, there
  /// are no rays or more than 2^26, sigma or growth is negative or not finite, or dropout or stray is not a
  /// probability
  Sensor(const FieldOfView& field_of_view, std::size_t columns, std::size_t rows, RangeErrors errors = {});

  [[nodiscard]] const FieldOfView& field_of_view() const { return field_of_view_; }
  [[nodiscard]] const RangeErrors& errors() const { return errors_; }

  /// Unit vectors in the sensor's frame (x forward, y left, z up): one for each column and row.
  [[nodiscard]] std::span<const Eigen::Vector3d> directions() const& { return directions_; }
  void directions() const&& = delete;  // they would go with the sensor

 private:
  FieldOfView field_of_view_;
  RangeErrors errors_;
  std::vector<Eigen::Vector3d> directions_;
};

/// The sensor of a robot. @throws std::invalid_argument as the sensor does
[[nodiscard]] Sensor sensor_of(const planner::RobotDescription& robot, RangeErrors errors = {});

/// What the sensor measures from here. A hit within the sensor's range gives its range with noise, clamped to
/// [0, max_range]; no hit gives infinity; a ray that drops out, whatever it meets, gives NaN. A stray ray
/// gives any range up to the surface, or to the sensor's, alike. Errors depend on the seed and the number of
/// the ray alone: the same arguments give the same bytes on any number of threads.
/// @param sensor_pose of the sensor itself, in the world frame
/// @throws std::invalid_argument if the pose is not finite
[[nodiscard]] planner::Scan sense(const Surface& surface, const Sensor& sensor,
                                  const planner::Pose& sensor_pose, std::uint64_t seed);

}  // namespace frontlux::sim
