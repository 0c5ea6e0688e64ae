#include <frontlux/field_of_view.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

void check_angle(const char* name, double angle, bool used) {
  if (used && !(angle > 0.0 && angle < std::numbers::pi))
    throw std::invalid_argument(std::string("field of view: ") + name + " angle is " + std::to_string(angle) +
                                " rad, but has to lie between 0 and pi");
}

}  // namespace

void FieldOfView::check() const {
  check_angle("horizontal", horizontal, !sees_all_around());
  check_angle("vertical", vertical, shape != Shape::kCone);
  if (!(max_range > 0.0 && std::isfinite(max_range)))
    throw std::invalid_argument("field of view: max_range is " + std::to_string(max_range) +
                                " m, but has to be positive");
}

bool FieldOfView::contains(const Eigen::Vector3d& offset, double yaw) const {
  if (shape == Shape::kSpinning) return contains_at_some_yaw(offset);
  const double squared = offset.squaredNorm();
  if (!(squared > 0.0 && squared <= max_range * max_range)) return false;
  const double cosine = std::cos(yaw), sine = std::sin(yaw);
  const double forward = offset.x() * cosine + offset.y() * sine;
  const double left = offset.y() * cosine - offset.x() * sine;
  switch (shape) {
    case Shape::kSpinning:
      break;
    case Shape::kPyramid:
      return std::fabs(left) <= std::tan(horizontal / 2) * forward &&
             std::fabs(offset.z()) <= std::tan(vertical / 2) * forward;
    case Shape::kCone:
      return forward >= std::cos(horizontal / 2) * std::sqrt(squared);
  }
  return false;
}

bool FieldOfView::contains_at_some_yaw(const Eigen::Vector3d& offset) const {
  const double squared = offset.squaredNorm();
  if (!(squared > 0.0 && squared <= max_range * max_range)) return false;
  return std::fabs(offset.z()) <= slope() * std::hypot(offset.x(), offset.y());
}

double FieldOfView::slope() const { return std::tan((shape == Shape::kCone ? horizontal : vertical) / 2); }

}  // namespace frontlux
