#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

namespace frontlux::sim {

/// One triangle, prepared to be compared with many boxes.
class TriangleOverlap {
 public:
  /// Corners [m]; they may coincide or lie on a line.
  TriangleOverlap(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

  /// The smallest box around the triangle.
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return bounds_; }

  /// Whether triangle and box have a point in common, borders included: exact but for the rounding of double.
  /// @pre the box is not empty
  [[nodiscard]] bool touches(const Eigen::AlignedBox3d& box) const;

 private:
  // A direction, and from where to where the triangle reaches along it.
  struct Shadow {
    Eigen::Vector3d axis;
    double low, high;
  };

  Eigen::AlignedBox3d bounds_;
  std::array<Shadow, 10> shadows_;
};

}  // namespace frontlux::sim
