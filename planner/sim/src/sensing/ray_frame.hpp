#pragma once

#include <Eigen/Core>

#include <array>
#include <optional>

namespace frontlux::sim {

/// Corners of a triangle [m], as the mesh has them.
using Corners = std::array<Eigen::Vector3f, 3>;

/// A ray seen along itself: space is sheared so that the ray becomes an axis. A triangle is hit if its
/// projection on the plane across that axis covers the axis.
///
/// No ray slips through an edge: a corner has the same projection for each of its triangles. The side of an
/// edge on which the axis lies comes out right, or as "on the edge", which counts as a hit for both
/// triangles. That needs the products below to be rounded one by one (no fused multiply-add), because then
/// rounding cannot reverse the order of two products.
class RayFrame {
 public:
  RayFrame() = default;
  RayFrame(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) : origin_(origin) {
    direction.cwiseAbs().maxCoeff(&along_);
    across_[0] = (along_ + 1) % 3;
    across_[1] = (along_ + 2) % 3;
    shear_[0] = direction[across_[0]] / direction[along_];
    shear_[1] = direction[across_[1]] / direction[along_];
    scale_ = 1.0 / direction[along_];
  }

  /// Where the ray meets the triangle, in lengths of its direction; may be negative. Nothing if it passes by,
  /// or sees the triangle exactly edge-on.
  [[nodiscard]] std::optional<double> hit(const Corners& corners) const {
    std::array<double, 3> x, y, z;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto from_origin = [&](Eigen::Index axis) {
        return static_cast<double>(corners[i][axis]) - origin_[axis];
      };
      z[i] = from_origin(along_);
      x[i] = from_origin(across_[0]) - shear_[0] * z[i];
      y[i] = from_origin(across_[1]) - shear_[1] * z[i];
    }
    const double u = x[2] * y[1] - y[2] * x[1];
    const double v = x[0] * y[2] - y[0] * x[2];
    const double w = x[1] * y[0] - y[1] * x[0];
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
    const double sum = u + v + w;
    if (sum == 0) return std::nullopt;
    return (u * z[0] + v * z[1] + w * z[2]) / sum * scale_;
  }

 private:
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::Index along_ = 0;
  std::array<Eigen::Index, 2> across_{};
  std::array<double, 2> shear_{};
  double scale_ = 0.0;
};

}  // namespace frontlux::sim
