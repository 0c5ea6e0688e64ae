#pragma once

#include <frontlux/planner/scan.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace frontlux::bench {

/// A closed hall of 80 x 40 x 12 m with columns and crates, in which sensors measure exactly.
class Hall {
 public:
  Hall();

  [[nodiscard]] Eigen::AlignedBox3d bounds() const;

  /// 32 beams within +-20 deg, 720 azimuths, 6 m.
  [[nodiscard]] planner::Scan lidar_scan(const Eigen::Vector3f& origin) const;

  /// 160 x 120 pixels, 90 x 72 deg, 10 m.
  /// @param yaw  [rad]
  [[nodiscard]] planner::Scan camera_scan(const Eigen::Vector3f& origin, float yaw) const;

 private:
  // Along a ray to the first surface [m]; infinity if that is beyond the range.
  [[nodiscard]] float range(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                            float max_range) const;

  std::vector<Eigen::AlignedBox3f> solids_;
};

}  // namespace frontlux::bench
