#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>

#include <Eigen/Core>

namespace frontlux {

/// A field of view at one yaw, to be asked about many points: answers as `FieldOfView::contains`, bit for
/// bit.
class FRONTLUX_EXPORT TurnedView {
 public:
  /// @param yaw [rad]
  TurnedView(const FieldOfView& view, double yaw);

  /// Whether a point is in view. The sensor's own position never is.
  /// @param offset  from the sensor to the point [m], along the world's axes
  [[nodiscard]] bool contains(const Eigen::Vector3d& offset) const;

 private:
  FieldOfView::Shape shape_;
  double squared_range_;              // [m^2]
  double cosine_ = 1.0, sine_ = 0.0;  // of the yaw
  double side_ = 0.0;                 // tangent of half of the horizontal angle, of a cone its cosine
  double rise_ = 0.0;                 // tangent of half of the vertical angle
};

}  // namespace frontlux
