#pragma once

#include "support/random_view.hpp"

#include <unsupported/Eigen/AutoDiff>

/// The information gain as exploration.md prints it, one logistic at a time, for any type of number: the
/// oracle of `InformationGain`.
namespace frontlux::test {

template <class T>
struct PoseOf {
  T x, y, z, yaw;
};

/// Membership of a point in the fuzzy view of a sensor.
/// @pre the point is not the sensor's own position
template <class T>
T membership(const PoseOf<T>& pose, const Eigen::Vector3d& point, const FieldOfView& view, double sharpness,
             double range_sharpness) {
  using std::cos, std::exp, std::sin, std::sqrt;
  const T dx = T(point.x()) - pose.x, dy = T(point.y()) - pose.y, dz = T(point.z()) - pose.z;
  const T range = sqrt(T(dx * dx + dy * dy + dz * dz));
  const T ux = dx / range, uy = dy / range, uz = dz / range;
  const T c = cos(pose.yaw), s = sin(pose.yaw);
  const T forward = ux * c + uy * s, left = uy * c - ux * s;
  const auto logistic = [](const T& x) { return T(T(1.0) / (T(1.0) + exp(T(-x)))); };
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

/// The gain of a scene's pairs from these poses.
template <class T>
T plain_gain(const Scene& scene, std::span<const PoseOf<T>> poses, const planner::GainOptions& options,
             double sharpness) {
  T sum(0.0), gain(0.0);
  std::vector<T> missed(scene.frontiers.size(), T(1.0));
  for (const auto& [i, j] : scene.list) {
    const T m = membership(poses[i], scene.frontiers[j], scene.view, sharpness, options.range_sharpness);
    sum = T(sum + m);
    missed[j] = T(missed[j] * T(T(1.0) - T(options.detection) * m));
  }
  for (const T& all : missed) gain = T(gain + T(T(1.0) - all));
  return options.mode == planner::GainMode::kSum ? sum : gain;
}

/// In long double, for differences.
inline double plain_gain(const Scene& scene, std::span<const planner::Pose> path,
                         const planner::GainOptions& options, double sharpness) {
  std::vector<PoseOf<long double>> poses;
  for (const auto& [at, yaw] : path) poses.push_back({at.x(), at.y(), at.z(), yaw});
  return static_cast<double>(plain_gain<long double>(scene, poses, options, sharpness));
}

/// By automatic differentiation: the derivatives by x, y, z and yaw of each viewpoint of the scene's path.
inline std::vector<Eigen::Vector4d> automatic_gradient(const Scene& scene,
                                                       const planner::GainOptions& options,
                                                       double sharpness) {
  using Dual = Eigen::AutoDiffScalar<Eigen::Vector4d>;
  std::vector<PoseOf<Dual>> poses;
  for (const auto& [at, yaw] : scene.path)
    poses.push_back({Dual(at.x()), Dual(at.y()), Dual(at.z()), Dual(yaw)});
  std::vector<Eigen::Vector4d> gradient;
  for (PoseOf<Dual>& pose : poses) {  // one viewpoint after the other is the variable
    const PoseOf<Dual> fixed = pose;
    pose = {Dual(pose.x.value(), 4, 0), Dual(pose.y.value(), 4, 1), Dual(pose.z.value(), 4, 2),
            Dual(pose.yaw.value(), 4, 3)};
    gradient.push_back(plain_gain<Dual>(scene, poses, options, sharpness).derivatives());
    pose = fixed;
  }
  return gradient;
}

}  // namespace frontlux::test
