#include "motion/departure.hpp"

#include <array>
#include <utility>

namespace frontlux::planner::detail {

std::optional<Departure> best_departure(const Trajectory& old, double time, const PathFrom& path_from,
                                        const MotionLimits& limits, const SegmentTest& is_free) {
  constexpr double kRest = 1e-3;  // [m/s] slower, it stops within less than two places differ by
  constexpr std::array kLeads = {0.1,  0.4, 0.7,
                                 1.01, 1.4, 2.0};  // of the distance in which the robot can stop
  const MotionState start = old.at(time);
  const double speed = start.velocity.norm();

  std::optional<Departure> best;
  double arrival = 0.0;
  const auto take = [&](Departure departure, const Trajectory& trajectory) {
    if (best && trajectory.end() >= arrival) return;
    arrival = trajectory.end();
    best = std::move(departure);
  };
  if (speed > kRest) {
    const Eigen::Vector3d direction = start.velocity / speed;
    const double stopping = speed * speed / (2 * limits.acceleration_along(direction));
    for (const double lead : kLeads) {
      const Pose ahead{start.pose.position + lead * stopping * direction, start.pose.yaw};
      if (!is_free(start.pose.position, ahead.position, Eigen::Vector3d::Zero())) break;
      std::vector<Pose> viewpoints = path_from(ahead);
      if (viewpoints.empty()) continue;
      viewpoints.insert(viewpoints.begin(), start.pose);
      if (const auto trajectory = Trajectory::through(start, time, viewpoints, limits, is_free))
        take({false, std::move(viewpoints)}, *trajectory);
    }
  }
  if (auto viewpoints = path_from(old.stop(time, limits)); !viewpoints.empty()) {
    const Trajectory trajectory = old.after_stop(time, viewpoints, limits, is_free);
    take({true, std::move(viewpoints)}, trajectory);
  }
  return best;
}

Trajectory depart(const Trajectory& old, double time, const Departure& departure, const MotionLimits& limits,
                  const SegmentTest& is_free) {
  if (departure.stops) return old.after_stop(time, departure.viewpoints, limits, is_free);
  return Trajectory::through(old.at(time), time, departure.viewpoints, limits, is_free).value();
}

}  // namespace frontlux::planner::detail
