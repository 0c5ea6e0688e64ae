#include "exploration/driven_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// The fewest of some poses between which their path is about straight.
std::vector<Pose> corners_of(std::span<const Pose> path) {
  constexpr double kOff = 0.03;  // [m]
  const auto straight = [&](std::size_t a, std::size_t b) {
    const Eigen::Vector3d along = (path[b].position - path[a].position).stableNormalized();
    for (std::size_t i = a + 1; i < b; ++i) {
      const Eigen::Vector3d to = path[i].position - path[a].position;
      if ((to - to.dot(along) * along).norm() > kOff) return false;
    }
    return true;
  };
  std::vector<Pose> corners;
  for (std::size_t kept = 0, i = 0; i < path.size(); ++i) {
    if (i > 0 && i + 1 < path.size() && straight(kept, i + 1)) continue;
    corners.push_back(path[i]);
    kept = i;
  }
  return corners;
}

std::vector<Pose> samples_along(const Trajectory& trajectory, double from, double until) {
  constexpr double kStep = 0.1, kMost = 1000.0;  // [s], poses
  const double begin = std::max(from, trajectory.begin());
  const double time = std::max(0.0, std::min(until, trajectory.end()) - begin);
  const double steps = std::clamp(std::ceil(time / kStep), 1.0, kMost);
  std::vector<Pose> samples;
  for (double i = 0.0; i <= steps; ++i) samples.push_back(trajectory.at(begin + i / steps * time).pose);
  return samples;
}

}  // namespace

std::vector<Pose> poses_along(const Trajectory& trajectory, double from, double until) {
  return corners_of(samples_along(trajectory, from, until));
}

void DrivenPath::follow(const Trajectory& trajectory, double until) {
  constexpr double kNear = 0.01;  // [m]
  if (until > until_) {
    for (const Pose& pose : samples_along(trajectory, until_, until))
      if (driven_.empty() || (pose.position - driven_.back().position).norm() > kNear)
        driven_.push_back(pose);
    until_ = until;
  }
}

std::vector<Pose> DrivenPath::through(std::span<const Pose> scanned, double far_apart) {
  std::vector<Pose> path;
  auto here = driven_.begin();  // what lies nearest to the scan before
  for (std::size_t i = 0; i < scanned.size(); ++i) {
    const Pose& to = scanned[i];
    const auto off = [&](const Pose& pose) { return (pose.position - to.position).norm(); };
    const auto next = std::ranges::min_element(here, driven_.end(), {}, off);
    if (i > 0 && off(scanned[i - 1]) > far_apart && next - here > 1) {
      std::vector<Pose> between{scanned[i - 1]};
      between.insert(between.end(), here + 1, next);
      between.push_back(to);
      const std::vector<Pose> corners = corners_of(between);
      path.insert(path.end(), corners.begin() + 1, corners.end());
    } else {
      path.push_back(to);
    }
    here = next;
  }
  driven_.erase(driven_.begin(), here);
  return path;
}

}  // namespace frontlux::planner::detail
