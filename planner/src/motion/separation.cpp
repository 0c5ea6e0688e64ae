#include "motion/separation.hpp"

#include <algorithm>

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
                 const RobotMotion& other, const Eigen::AlignedBox3d& other_body, double gap, double speeds) {
  constexpr double kLeast = 0.002;    // [m] by which robots move before it is looked again,
  constexpr double kShortest = 1e-4;  // [s] but no sooner
  constexpr double kRounding = 1e-9;  // [m] places that are just not too near are far enough
  const double end = std::max(trajectory.end(), other.rests_from());
  const auto gap_at = [&](double time) {
    return gap_between(body.translated(trajectory.at(time).pose.position),
                       other_body.translated(other.at(time).pose.position));
  };
  double now = gap_at(from);
  const double least = std::min(gap, now) - kRounding;
  for (double time = from; time < end;) {
    // They cannot be too near before they have moved so far together.
    time = std::min(time + std::max(std::max(kLeast, now - least) / speeds, kShortest), end);
    now = gap_at(time);
    if (now < least) return false;
  }
  return true;
}

}  // namespace frontlux::planner::detail
