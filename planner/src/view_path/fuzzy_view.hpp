#pragma once

#include <frontlux/field_of_view.hpp>

#include <Eigen/Core>

#include <cmath>

namespace frontlux::planner {

/// A viewpoint whose parts are numbers that may know their derivatives.
template <class T>
struct PoseOf {
  T x, y, z, yaw;
};

/// The logistic function.
template <class T>
[[nodiscard]] T logistic(const T& x) {
  using std::exp;
  return T(1.0) / (T(1.0) + exp(-x));
}

/// Membership of a point in the fuzzy view of a sensor: the formula as it is written down, for any number
/// type that has arithmetic, sqrt, sin, cos and exp. Differentiated automatically; the fast evaluation in
/// `information_gain.cpp` is written on its own.
/// @pre the point is not the sensor's own position
template <class T>
[[nodiscard]] T membership(const PoseOf<T>& pose, const Eigen::Vector3d& point, const FieldOfView& view,
                           double sharpness, double range_sharpness) {
  using std::cos, std::sin, std::sqrt;
  const T dx = T(point.x()) - pose.x, dy = T(point.y()) - pose.y, dz = T(point.z()) - pose.z;
  const T range = sqrt(T(dx * dx + dy * dy + dz * dz));
  const T ux = dx / range, uy = dy / range, uz = dz / range;
  const T c = cos(pose.yaw), s = sin(pose.yaw);
  const T forward = ux * c + uy * s, left = uy * c - ux * s;
  const auto inside = [&](const T& distance) { return logistic(T(distance * T(sharpness))); };
  const auto between = [&](double angle, const T& along, const T& across) {
    const T a = along * T(std::sin(angle / 2)), b = across * T(std::cos(angle / 2));
    return T(inside(T(a - b)) * inside(T(a + b)));
  };
  const T in_range = logistic(T((T(view.max_range) - range) * T(range_sharpness)));
  switch (view.shape) {
    case FieldOfView::Shape::kSpinning:
      return in_range * between(view.vertical, sqrt(T(ux * ux + uy * uy)), uz);
    case FieldOfView::Shape::kPyramid:
      return in_range * between(view.horizontal, forward, left) * between(view.vertical, forward, uz);
    case FieldOfView::Shape::kCone:
      return in_range * inside(T(forward - T(std::cos(view.horizontal / 2))));
  }
  return T(0.0);
}

}  // namespace frontlux::planner
