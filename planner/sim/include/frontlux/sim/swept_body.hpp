#pragma once

#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/sim/swept_box.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

namespace frontlux::sim {

/// The space that a body passes through on a straight motion: a box, an upright cylinder or a sphere.
///
/// A box is compared at once. A round body is compared at places at most a millimetre apart, both ends
/// included, and exactly there.
class SweptBody {
 public:
  /// @param start   the smallest box around the body where the motion begins, not empty; of a cylinder it is
  ///                as wide as it is long, of a sphere a cube
  /// @param motion  [m]
  SweptBody(planner::BodyShape shape, const Eigen::AlignedBox3d& start, const Eigen::Vector3d& motion);

  /// The smallest axis-aligned box around.
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return around_.bounds(); }

  /// Whether it has a point in common with a triangle, borders included, but for rounding.
  [[nodiscard]] bool touches(const std::array<Eigen::Vector3d, 3>& triangle) const;

 private:
  planner::BodyShape shape_;
  SweptBox around_;
  Eigen::Vector3d center_, half_, motion_;
};

}  // namespace frontlux::sim
