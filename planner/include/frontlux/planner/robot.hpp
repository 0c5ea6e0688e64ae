#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>
#include <frontlux/planner/motion_limits.hpp>
#include <frontlux/planner/travel_corridor.hpp>

#include <cstddef>
#include <cstdint>
#include <string>

namespace frontlux::planner {

/// Which method to use where something works better than the paper's.
enum class Method : std::uint8_t {
  kDefault,  ///< what works best
  kPaper,    ///< the paper's, as printed
};

/// A robot as planning sees it. Its pose is that of its sensor: above the floor if it drives, in space
/// the middle of its body.
struct FRONTLUX_EXPORT Robot {
  std::string name;      ///< in messages
  TravelOptions travel;  ///< where it fits
  FieldOfView view;      ///< what it sees from there
  MotionLimits limits;   ///< how fast it is

  /// [m] of the sensor above the floor where the robot stands or, in space, above its middle
  [[nodiscard]] double mount_height() const { return travel.drives() ? travel.sensor_height : 0.0; }

  /// @throws std::invalid_argument naming the value of the field of view or the limits that is out of bounds
  void check() const {
    view.check();
    limits.check();
  }
};

/// The paper's ground robot: 1.0 x 1.0 x 0.7 m on one plane, a lidar that sees all around, 20 degrees up and
/// down, and 6 m far. Limits as in `MotionLimits`, which the paper does not say.
[[nodiscard]] FRONTLUX_EXPORT Robot ugv();

/// The paper's aerial robot: a cube of 0.8 m, a depth camera of 90 x 72 degrees that sees 10 m far. It goes
/// where its box fits; as printed, through free octree nodes of 1.2 m. 1.5 m/s, else as the ground robot.
[[nodiscard]] FRONTLUX_EXPORT Robot uav(Method method = Method::kDefault);

/// A robot for motion, where robots keep apart in time instead of by height, as `frontlux explore` has those
/// above: in space it goes as low as its body allows. Its margin is half of what the voxels around its body
/// leave it to each side, so that no passage is closed by it, and at most 0.05 m: off the middles of voxels a
/// body comes near to surfaces in voxels that the map has as free.
/// @param resolution  [m] of the map
/// @throws std::invalid_argument unless that is a length
[[nodiscard]] FRONTLUX_EXPORT Robot in_motion(Robot robot, double resolution);

/// A robot with the number of rays in a scan of its sensor, and how often it takes one.
struct RobotDescription {
  /// Its body, its sensor and its limits.
  Robot robot;
  std::size_t columns = 0;  ///< azimuths of a spinning sensor, pixels in a row of a camera
  std::size_t rows = 0;     ///< beams of a spinning sensor, pixels in a column of a camera
  double rate = 10.0;       ///< [1/s] of scans, in motion
};

/// The paper's robots: 32 beams x 720 azimuths, 10 a second; 160 x 120 pixels, 15 a second.
[[nodiscard]] FRONTLUX_EXPORT RobotDescription ugv_description();
[[nodiscard]] FRONTLUX_EXPORT RobotDescription uav_description(Method method = Method::kDefault);

}  // namespace frontlux::planner
