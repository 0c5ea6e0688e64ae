#pragma once

#include "support/random.hpp"
#include "support/views.hpp"

#include <frontlux/planner/information_gain.hpp>
#include <frontlux/planner/visible_pairs.hpp>

namespace frontlux::test {

/// A path among frontiers, and who sees whom.
struct Scene {
  std::vector<planner::Pose> path;
  std::vector<Eigen::Vector3d> frontiers;
  std::vector<planner::VisiblePair> list;
  FieldOfView view;

  [[nodiscard]] planner::VisiblePairs pairs() const { return {path.size(), frontiers.size(), list}; }
  [[nodiscard]] std::vector<double> yaws() const {
    std::vector<double> all;
    for (const auto& pose : path) all.push_back(pose.yaw);
    return all;
  }
  [[nodiscard]] planner::InformationGain gain(const planner::GainOptions& options = {}) const {
    return {path, frontiers, pairs(), view, options};
  }
};

/// A walk of viewpoints among frontiers that are thrown about it, `share` of the pairs visible.
inline Scene random_scene(Random& random, int viewpoints, int frontiers, double share = 0.7,
                          const FieldOfView& view = camera()) {
  Scene scene{{}, {}, {}, view};
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double heading = random.uniform(-4.0, 4.0);
  for (int i = 0; i < viewpoints; ++i) {
    scene.path.push_back({at, heading});
    heading += random.uniform(-0.6, 0.6);
    at += 1.2 * Eigen::Vector3d(std::cos(heading), std::sin(heading), random.uniform(-0.2, 0.2));
  }
  for (int j = 0; j < frontiers; ++j) {
    const Eigen::Vector3d off = random.point(-9, 9).cwiseProduct(Eigen::Vector3d(1, 1, 1.0 / 3));
    scene.frontiers.push_back(random.pick(scene.path).position + off);
    for (int i = 0; i < viewpoints; ++i)
      if (random.uniform(0, 1) < share)
        scene.list.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
  }
  return scene;
}

/// Distinct frontiers in view, pair by pair.
inline std::uint64_t distinct_by_hand(const Scene& scene, const std::vector<double>& yaws) {
  std::vector<bool> seen(scene.frontiers.size(), false);
  for (const auto& [i, j] : scene.list)
    if (scene.view.contains(scene.frontiers[j] - scene.path[i].position, yaws[i])) seen[j] = true;
  std::uint64_t count = 0;
  for (const bool one : seen) count += one ? 1U : 0U;
  return count;
}

}  // namespace frontlux::test
