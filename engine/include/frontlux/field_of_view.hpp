#pragma once

#include <frontlux/export.hpp>

#include <Eigen/Core>

#include <cstdint>

namespace frontlux {

/// The space that a range sensor sees: a solid of directions, cut off at a range. Sensor frame: x forward, y
/// left, z up. A robot turns about z only: pitch and roll are 0.
struct FRONTLUX_EXPORT FieldOfView {
  /// The form of the solid.
  enum class Shape : std::uint8_t {
    kSpinning,  ///< all azimuths, elevations within +-vertical / 2: a lidar
    kPyramid,   ///< |left| <= tan(horizontal / 2) forward and |up| <= tan(vertical / 2) forward: a camera
    kCone,      ///< within horizontal / 2 of the forward axis: a sonar
  };

  /// Its form.
  Shape shape = Shape::kSpinning;
  double horizontal = 0.0;  ///< [rad] full opening angle, in (0, pi) for pyramids and cones; else not used
  double vertical = 0.0;    ///< [rad] full opening angle, in (0, pi); not used by cones
  double max_range = 0.0;   ///< [m] Euclidean, positive

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;

  /// Whether the yaw makes no difference to what is in view.
  [[nodiscard]] bool sees_all_around() const { return shape == Shape::kSpinning; }

  /// Whether a point is in view at this yaw [rad]. The sensor's own position never is.
  /// @param offset  from the sensor to the point [m], along the world's axes
  [[nodiscard]] bool contains(const Eigen::Vector3d& offset, double yaw) const;

  /// Whether a point is in view at some yaw: within range, and not too far above or below.
  [[nodiscard]] bool contains_at_some_yaw(const Eigen::Vector3d& offset) const;

  /// Tangent of the greatest elevation that is in view.
  [[nodiscard]] double slope() const;
};

}  // namespace frontlux
