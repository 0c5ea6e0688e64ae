// The gain of a path whose viewpoints may move: by hand in closed form, and by automatic differentiation.
// Both work pair by pair; `information_gain.cpp` has the fast way for yaws alone.

#include "view_path/fuzzy_view.hpp"

#include <frontlux/planner/information_gain.hpp>

#include <unsupported/Eigen/AutoDiff>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

using Dual = Eigen::AutoDiffScalar<Eigen::Vector4d>;  // by x, y, z and yaw of one viewpoint

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
      // Straight above and below the horizontal direction of a point is none, and its derivative is taken as
      // 0.
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
  // Of the logarithm of the membership: d log sigma(k s) = k (1 - sigma) ds, where du/dp = (u u' - 1) /
  // range.
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

PoseOf<Dual> constant(const Pose& pose) {
  return {Dual(pose.position.x()), Dual(pose.position.y()), Dual(pose.position.z()), Dual(pose.yaw)};
}

PoseOf<Dual> variable(const Pose& pose) {
  return {Dual(pose.position.x(), 4, 0), Dual(pose.position.y(), 4, 1), Dual(pose.position.z(), 4, 2),
          Dual(pose.yaw, 4, 3)};
}

// The gain as it is written down, frontier by frontier.
Dual plain_gain(std::span<const PoseOf<Dual>> poses, std::span<const Eigen::Vector3d> frontiers,
                const VisiblePairs& pairs, const FieldOfView& view, const GainOptions& options,
                double sharpness) {
  Dual gain(0.0);
  for (std::size_t j = 0; j < frontiers.size(); ++j) {
    Dual sum(0.0), missed(1.0);
    for (const std::uint32_t i : pairs.viewpoints_of(j)) {
      const auto& pose = poses[i];
      const bool apart = Eigen::Vector3d(pose.x.value(), pose.y.value(), pose.z.value()) != frontiers[j];
      if (!apart) continue;
      const Dual m = membership(pose, frontiers[j], view, sharpness, options.range_sharpness);
      sum = Dual(sum + m);
      missed = Dual(missed * Dual(1.0 - options.detection * m));
    }
    gain = options.mode == GainMode::kSum ? Dual(gain + sum) : Dual(gain + (1.0 - missed));
  }
  return gain;
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

double InformationGain::automatic_value_at(std::span<const Pose> poses, double sharpness,
                                           std::span<PoseGradient> gradient) const {
  check_poses(poses, gradient.size());
  check_sharpness(sharpness);
  std::vector<VisiblePair> list;
  list.reserve(seen_.size());
  for (std::size_t i = 0; i < viewpoints(); ++i)
    for (const std::uint32_t j : frontiers_of(i)) list.push_back({static_cast<std::uint32_t>(i), j});
  const VisiblePairs pairs(viewpoints(), frontiers_.size(), list);
  std::vector<PoseOf<Dual>> numbers;
  for (const Pose& pose : poses) numbers.push_back(constant(pose));
  double gain = 0.0;
  for (std::size_t i = 0; i < viewpoints(); ++i) {  // one viewpoint after the other is the variable
    const PoseOf<Dual> fixed = numbers[i];
    numbers[i] = variable(poses[i]);
    const Dual all = plain_gain(numbers, frontiers_, pairs, view_, options_, sharpness);
    numbers[i] = fixed;
    gain = all.value();
    gradient[i] = {all.derivatives().head<3>(), all.derivatives()[3]};
  }
  return gain;
}

}  // namespace frontlux::planner
