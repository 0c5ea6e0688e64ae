#pragma once

#include <Eigen/Core>

#include <cstdint>

namespace frontlux {

/// What a range sensor sees of the space around it: a solid of directions, cut off at a range. Sensor frame:
/// x forward, y left, z up; a robot turns about z only (exploration on a plane or in the air, pitch and roll
/// 0).
struct FieldOfView {
  enum class Shape : std::uint8_t {
    kSpinning,  ///< all azimuths, elevations within +-vertical / 2: a lidar
    kPyramid,   ///< |left| <= tan(horizontal / 2) forward and |up| <= tan(vertical / 2) forward: a camera
    kCone,      ///< within horizontal / 2 of the forward axis: a sonar
  };

  Shape shape = Shape::kSpinning;
  double horizontal = 0.0;  ///< [rad] full opening angle, in (0, pi) for pyramids and cones; else not used
  double vertical = 0.0;    ///< [rad] full opening angle, in (0, pi); not used by cones
  double max_range = 0.0;   ///< [m] Euclidean, positive

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;

  /// Whether a point at this offset from the sensor [m], along the world's axes, is in view at this yaw
  /// [rad]. The sensor's own position is not.
  [[nodiscard]] bool contains(const Eigen::Vector3d& offset, double yaw) const;

  /// Whether it is in view at some yaw: within range, and not too far above or below.
  [[nodiscard]] bool contains_at_some_yaw(const Eigen::Vector3d& offset) const;
};

}  // namespace frontlux
