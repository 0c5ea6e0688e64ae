#include "input_file.hpp"
#include "recorded_pose.hpp"

#include <frontlux/io/recorded_scan.hpp>

#include <cmath>

namespace frontlux::planner {

std::vector<Eigen::Vector3f> points_in_world(const RecordedScan& scan) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3d p = scan.T_world_sensor * point.cast<double>();
    points.emplace_back(detail::to_float(p.x()), detail::to_float(p.y()), detail::to_float(p.z()));
  }
  return points;
}

std::optional<Eigen::Isometry3d> detail::pose_from(const Eigen::Vector3d& position,
                                                   const Eigen::Quaterniond& orientation) {
  constexpr double kTolerance = 1e-3;
  if (!position.allFinite() || !orientation.coeffs().allFinite()) return std::nullopt;
  if (!(std::fabs(orientation.norm() - 1.0) <= kTolerance)) return std::nullopt;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = orientation.normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

}  // namespace frontlux::planner
