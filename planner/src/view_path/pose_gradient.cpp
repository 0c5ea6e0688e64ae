// The gain of a path whose viewpoints may move, in closed form and pair by pair. `information_gain.cpp` is
// faster, and for yaws alone.

#include <frontlux/planner/information_gain.hpp>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

struct Membership {
  double value = 0.0;
  PoseGradient slope;
};

// A plane through the sensor, or a cone about it: s = normal . u - threshold >= 0 inside, u the direction of
// the point, turning with the sensor at rate ds/dyaw.
struct Boundary {
  Eigen::Vector3d normal;
  double threshold = 0.0;
  double rate = 0.0;
};

struct Boundaries {
  std::array<Boundary, 4> at;
  std::size_t count = 0;
  void add(const Boundary& boundary) { at[count++] = boundary; }
  // Both sides of an opening angle: `along` points into it, `across` out of it.
  void add_pair(double angle, const Eigen::Vector3d& along, double along_rate, const Eigen::Vector3d& across,
                double across_rate) {
    const double a = std::sin(angle / 2), b = std::cos(angle / 2);
    add({a * along - b * across, 0.0, a * along_rate - b * across_rate});
    add({a * along + b * across, 0.0, a * along_rate + b * across_rate});
  }
};

Boundaries boundaries(const FieldOfView& view, double yaw, const Eigen::Vector3d& u) {
  const Eigen::Vector3d ahead(std::cos(yaw), std::sin(yaw), 0.0), aside(-ahead.y(), ahead.x(), 0.0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double forward = ahead.dot(u), left = aside.dot(u);
  Boundaries all;
  switch (view.shape) {
    case FieldOfView::Shape::kSpinning: {
      const double flat = std::hypot(u.x(), u.y());
      // Straight above and below there is no horizontal direction, and its derivative is taken as 0.
      const Eigen::Vector3d along = flat > 0.0 ? Eigen::Vector3d(u.x() / flat, u.y() / flat, 0.0)
                                               : Eigen::Vector3d(Eigen::Vector3d::Zero());
      all.add_pair(view.vertical, along, 0.0, up, 0.0);
      break;
    }
    case FieldOfView::Shape::kPyramid:
      all.add_pair(view.horizontal, ahead, left, aside, -forward);
      all.add_pair(view.vertical, ahead, left, up, 0.0);
      break;
    case FieldOfView::Shape::kCone:
      all.add({ahead, std::cos(view.horizontal / 2), left});
      break;
  }
  return all;
}

Membership closed_form(const Pose& pose, const Eigen::Vector3d& point, const FieldOfView& view,
                       double sharpness, double range_sharpness) {
  const Eigen::Vector3d offset = point - pose.position;
  const double range = offset.norm();
  if (!(range > 0.0 && std::isfinite(range))) return {};
  const Eigen::Vector3d u = offset / range;
  const Boundaries all = boundaries(view, pose.yaw, u);
  const double in_range = 1.0 / (1.0 + std::exp(-range_sharpness * (view.max_range - range)));
  // Of the logarithm of the membership: d log sigma(k s) = k (1 - sigma) ds, du/dp = (u u' - 1) / range.
  Membership m{in_range, {range_sharpness * (1.0 - in_range) * u, 0.0}};
  for (std::size_t b = 0; b < all.count; ++b) {
    const auto& [normal, threshold, rate] = all.at[b];
    const double projected = normal.dot(u);
    const double inside = 1.0 / (1.0 + std::exp(-sharpness * (projected - threshold)));
    const double pull = sharpness * (1.0 - inside);
    m.value *= inside;
    m.slope.position += pull / range * (projected * u - normal);
    m.slope.yaw += pull * rate;
  }
  m.slope.position *= m.value;
  m.slope.yaw *= m.value;
  return m;
}

}  // namespace

void InformationGain::check_poses(std::span<const Pose> poses, std::size_t gradients) const {
  if (poses.size() != viewpoints() || gradients != viewpoints())
    throw std::invalid_argument("information gain: " + std::to_string(poses.size()) + " poses and " +
                                std::to_string(gradients) + " gradients for " + std::to_string(viewpoints()) +
                                " viewpoints");
  check_finite(poses);
}

double InformationGain::value_at(std::span<const Pose> poses, double sharpness,
                                 std::span<PoseGradient> gradient) const {
  check_poses(poses, gradient.size());
  check_sharpness(sharpness);
  std::vector<Membership> m(seen_.size());
  std::vector<double> missed(frontiers_.size(), 1.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < viewpoints(); ++i)
    for (std::size_t p = first_[i]; p < first_[i + 1]; ++p) {
      m[p] = closed_form(poses[i], frontiers_[seen_[p]], view_, sharpness, options_.range_sharpness);
      missed[seen_[p]] *= 1.0 - options_.detection * m[p].value;
      sum += m[p].value;
    }
  const bool counted_once = options_.mode == GainMode::kOr;
  for (std::size_t i = 0; i < viewpoints(); ++i) {
    gradient[i] = {};
    for (std::size_t p = first_[i]; p < first_[i + 1]; ++p) {
      const double weight =
          counted_once ? options_.detection * missed[seen_[p]] / (1.0 - options_.detection * m[p].value)
                       : 1.0;
      gradient[i].position += weight * m[p].slope.position;
      gradient[i].yaw += weight * m[p].slope.yaw;
    }
  }
  if (!counted_once) return sum;
  double gain = 0.0;
  for (const double all : missed) gain += 1.0 - all;
  return gain;
}

}  // namespace frontlux::planner
