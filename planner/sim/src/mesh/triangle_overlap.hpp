#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

namespace frontlux::sim {

/// One triangle, prepared to be compared with many boxes.
class TriangleOverlap {
 public:
  /// @param corners [m] they may coincide or lie on a line
  explicit TriangleOverlap(const std::array<Eigen::Vector3d, 3>& corners);

  /// The smallest box around the triangle.
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return bounds_; }

  /// Whether triangle and box have a point in common, borders included: exact but for the rounding of double.
  /// @pre the box is not empty
  [[nodiscard]] bool touches(const Eigen::AlignedBox3d& box) const;

 private:
  // What the triangle covers along a direction.
  struct Projection {
    Eigen::Vector3d axis;
    double low, high;
  };

  Eigen::AlignedBox3d bounds_;
  std::array<Projection, 10> projections_;
};

}  // namespace frontlux::sim
