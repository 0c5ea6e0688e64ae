#include "motion/separation.hpp"

#include <algorithm>
#include <cmath>

namespace frontlux::planner::detail {

double gap_between(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return (a.min() - b.max()).cwiseMax(b.min() - a.max()).maxCoeff();
}

Eigen::AlignedBox3d positions_too_near(const Eigen::AlignedBox3d& body, const Eigen::AlignedBox3d& other,
                                       const Eigen::Vector3d& other_at, double gap) {
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(gap);
  return {other_at + other.min() - body.max() - around, other_at + other.max() - body.min() + around};
}

bool keeps_apart(const Trajectory& trajectory, double from, const Eigen::AlignedBox3d& body,
                 const RobotMotion& other, const Eigen::AlignedBox3d& other_body, double gap) {
  constexpr double kStep = 0.01;      // [s] in which two robots hardly come nearer
  constexpr double kRounding = 1e-9;  // [m] places that are just not too near are far enough
  const double end = std::max(trajectory.end(), other.rests_from());
  const auto gap_at = [&](double time) {
    return gap_between(body.translated(trajectory.at(time).pose.position),
                       other_body.translated(other.at(time).pose.position));
  };
  const double least = std::min(gap, gap_at(from)) - kRounding;
  const double steps = std::ceil((end - from) / kStep);
  for (double i = 1.0; i <= steps; ++i)
    if (gap_at(std::min(from + i * kStep, end)) < least) return false;
  return true;
}

}  // namespace frontlux::planner::detail
