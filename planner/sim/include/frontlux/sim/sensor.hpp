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

/// How a sensor errs. By default it does not.
struct RangeErrors {
  double sigma = 0.0;    ///< [m] standard deviation of the Gaussian noise on a range
  double dropout = 0.0;  ///< probability that a ray gives no measurement, whatever it meets
};

/// A range sensor: its field of view, the rays that fill it, and its errors.
class Sensor {
 public:
  /// Rays by the shape of the field of view, row by row from the top:
  /// - pyramid: pixels of equal size on the image plane, rays through their centres, columns from the left;
  /// - spinning: rows are beams, elevations evenly spaced with both extremes included (one row: elevation 0);
  ///   columns are azimuths 2 pi c / columns, counter-clockwise, from straight ahead;
  /// - cone: columns x rows rays in a spiral from the axis outwards, each for the same solid angle.
  /// @throws std::invalid_argument naming the value, if the field of view does not pass its `check`, there
  /// are no rays or more than 2^26, sigma is negative or not finite, or dropout is not a probability
  Sensor(const FieldOfView& field_of_view, std::size_t columns, std::size_t rows, RangeErrors errors = {});

  [[nodiscard]] const FieldOfView& field_of_view() const { return field_of_view_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const RangeErrors& errors() const { return errors_; }

  /// Unit vectors in the sensor's frame (x forward, y left, z up), columns() * rows() of them.
  [[nodiscard]] std::span<const Eigen::Vector3d> directions() const& { return directions_; }
  void directions() const&& = delete;  // they would go with the sensor

 private:
  FieldOfView field_of_view_;
  std::size_t columns_, rows_;
  RangeErrors errors_;
  std::vector<Eigen::Vector3d> directions_;
};

/// The aerial robot's: 160 x 120 pixels, 90 x 72 degrees, 10 m.
[[nodiscard]] Sensor depth_camera(RangeErrors errors = {});

/// The ground robot's: 32 beams x 720 azimuths, +-20 degrees, 6 m.
[[nodiscard]] Sensor lidar(RangeErrors errors = {});

/// A cone of `rays` rays about the forward axis.
/// @param opening [rad] full angle, in (0, pi)
/// @param max_range [m]
[[nodiscard]] Sensor cone_sensor(double opening, double max_range, std::size_t rays, RangeErrors errors = {});

/// A robot's own. @throws std::invalid_argument as the sensor does
[[nodiscard]] Sensor sensor_of(const planner::RobotDescription& robot, RangeErrors errors = {});

/// What the sensor measures from here. A hit within the sensor's range gives its range with noise, held
/// within 0 and max_range; no hit gives infinity; a dropout, which may befall any ray, NaN. Errors are drawn
/// by seed and number of the ray: the same arguments give the same bytes on any number of threads.
/// @param sensor_pose of the sensor itself, in the world frame
/// @throws std::invalid_argument if the pose is not finite
[[nodiscard]] planner::Scan sense(const Surface& surface, const Sensor& sensor,
                                  const planner::Pose& sensor_pose, std::uint64_t seed);

}  // namespace frontlux::sim
