#include <frontlux/field_of_view.hpp>
#include <frontlux/turned_view.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

void check_angle(const char* name, double angle) {
  if (!(angle > 0.0 && angle < std::numbers::pi))
    throw std::invalid_argument(std::string("field of view: ") + name + " angle is " + std::to_string(angle) +
                                " rad, but has to lie between 0 and pi");
}

}  // namespace

void FieldOfView::check() const {
  if (shape > Shape::kCone)
    throw std::invalid_argument("field of view: shape has the unknown value " +
                                std::to_string(static_cast<int>(shape)));
  switch (shape) {
    case Shape::kSpinning:
      check_angle("vertical", vertical);
      break;
    case Shape::kPyramid:
      check_angle("horizontal", horizontal);
      check_angle("vertical", vertical);
      break;
    case Shape::kCone:
      check_angle("horizontal", horizontal);
      break;
  }
  if (!(max_range > 0.0 && std::isfinite(max_range)))
    throw std::invalid_argument("field of view: max_range is " + std::to_string(max_range) +
                                " m, but has to be positive and finite");
}

TurnedView::TurnedView(const FieldOfView& view, double yaw)
    : shape_(view.shape), squared_range_(view.max_range * view.max_range) {
  switch (shape_) {
    case FieldOfView::Shape::kSpinning:
      rise_ = view.slope();
      return;
    case FieldOfView::Shape::kPyramid:
      side_ = std::tan(view.horizontal / 2);
      rise_ = std::tan(view.vertical / 2);
      break;
    case FieldOfView::Shape::kCone:
      side_ = std::cos(view.horizontal / 2);
      break;
  }
  cosine_ = std::cos(yaw);
  sine_ = std::sin(yaw);
}

bool TurnedView::contains(const Eigen::Vector3d& offset) const {
  const double squared = offset.squaredNorm();
  if (!(squared > 0.0 && squared <= squared_range_)) return false;
  const auto ahead = [&] { return offset.x() * cosine_ + offset.y() * sine_; };
  switch (shape_) {
    case FieldOfView::Shape::kSpinning:
      return std::fabs(offset.z()) <= rise_ * std::hypot(offset.x(), offset.y());
    case FieldOfView::Shape::kCone:
      return ahead() >= side_ * std::sqrt(squared);
    case FieldOfView::Shape::kPyramid:
      break;
  }
  const double forward = ahead();
  const double left = offset.y() * cosine_ - offset.x() * sine_;
  return std::fabs(left) <= side_ * forward && std::fabs(offset.z()) <= rise_ * forward;
}

bool FieldOfView::contains(const Eigen::Vector3d& offset, double yaw) const {
  return TurnedView(*this, yaw).contains(offset);
}

bool FieldOfView::contains_at_some_yaw(const Eigen::Vector3d& offset) const {
  const double squared = offset.squaredNorm();
  if (!(squared > 0.0 && squared <= max_range * max_range)) return false;
  return std::fabs(offset.z()) <= slope() * std::hypot(offset.x(), offset.y());
}

double FieldOfView::slope() const {
  switch (shape) {
    case Shape::kCone:
      return std::tan(horizontal / 2);
    case Shape::kSpinning:
    case Shape::kPyramid:
      break;
  }
  return std::tan(vertical / 2);
}

}  // namespace frontlux
