#include "explorer.hpp"

#include <frontlux/planner/exploration_start.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

using namespace frontlux;
using namespace frontlux::planner;

namespace {

// Where it looks, by its x axis.
Pose upright(const Eigen::Isometry3d& T_map_sensor) {
  return {T_map_sensor.translation(), yaw_along(T_map_sensor.linear().col(0))};
}

Scan scan_of(const Eigen::Isometry3d& T_map_cloud, std::span<const Eigen::Vector3f> points,
             double max_range) {
  Scan scan;
  scan.origin = T_map_cloud.translation().cast<float>();
  scan.max_range = max_range;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d ray = T_map_cloud.linear() * point.cast<double>();
    const double range = ray.norm();
    if (!std::isfinite(range) || range == 0.0) continue;
    scan.directions.push_back((ray / range).cast<float>());
    scan.ranges.push_back(range <= max_range ? static_cast<float>(range)
                                             : std::numeric_limits<float>::infinity());
  }
  return scan;
}

}  // namespace

Explorer::Explorer(Options options) : options_(std::move(options)) {
  options_.robot.check();
  static_cast<void>(Lattice(options_.resolution));  // refuses what is no length
  if (!(options_.reach.array() > 0.0).all() || !options_.reach.allFinite())
    throw std::invalid_argument("reach has to be above 0 m");
  constexpr double kWidest = 10.0;  // [m]
  if (!(options_.free_radius >= 0.0 && options_.free_radius <= kWidest))
    throw std::invalid_argument("free_radius has to be 0 to 10 m");
}

void Explorer::begin(double time, const Pose& pose) {
  const Lattice lattice(options_.resolution);
  if (!lattice.key(pose.position) || !std::isfinite(pose.yaw))
    throw std::invalid_argument("the pose is not finite, or outside the key range");
  const KeyBox bounds = voxels_of(lattice, {pose.position - options_.reach, pose.position + options_.reach});
  ExplorationOptions options = tour_options(options_.resolution);
  options.latency = options_.latency;
  options_.robot.travel.floor = pose.position.z() - options_.reach.z();
  options.team.push_back(
      {options_.robot, motion_goal_options(options_.robot, Method::kDefault, options.epsilon)});
  ContinuousExploration exploration(options, Mapping({.resolution = options_.resolution, .bounds = bounds}));
  const ExplorationStart start = start_at(lattice, options_.robot, pose, options_.free_radius);
  exploration.begin({&start, 1}, time);
  exploration_ = std::move(exploration);
  time_ = time;
}

std::optional<std::vector<Explorer::Waypoint>> Explorer::insert(double time,
                                                                const Eigen::Isometry3d& T_map_sensor,
                                                                const Eigen::Isometry3d& T_map_cloud,
                                                                std::span<const Eigen::Vector3f> points,
                                                                double rate) {
  if (!std::isfinite(time)) throw std::invalid_argument("the time is not finite");
  const Pose pose = upright(T_map_sensor);
  const Scan scan = scan_of(T_map_cloud, points, options_.robot.view.max_range);
  if (!exploration_) {
    check(scan);  // before anything has begun
    begin(time, pose);
  }
  exploration_->insert(0, pose, scan);
  if (time < time_) return std::nullopt;
  time_ = time;
  std::optional<std::vector<Waypoint>> waypoints;
  while (!exploration_->end()) {
    const auto planned = exploration_->plan(time);
    if (!planned) break;
    const Trajectory& trajectory = planned->trajectory;
    waypoints.emplace();
    for (int i = 0; trajectory.begin() + i / rate < trajectory.end(); ++i) {
      const double at = trajectory.begin() + i / rate;
      waypoints->push_back({at, trajectory.at(at).pose});
    }
    waypoints->push_back({trajectory.end(), trajectory.at(trajectory.end()).pose});
  }
  return waypoints;
}

void Explorer::stopped(double time, const Eigen::Isometry3d& T_map_sensor) {
  if (!exploration_) throw std::invalid_argument("there was no scan yet");
  time_ = std::max(time, time_);
  exploration_->stopped(0, upright(T_map_sensor), time_, {});
}

void Explorer::displaced(double time, const Eigen::Isometry3d& T_map_sensor) {
  if (!exploration_) throw std::invalid_argument("there was no scan yet");
  time_ = std::max(time, time_);
  exploration_->displaced(0, upright(T_map_sensor), time_);
}

std::optional<std::string> Explorer::end() const {
  if (!exploration_ || !exploration_->end()) return std::nullopt;
  return describe(*exploration_->end(), exploration_->options(), "plannings");
}

const octomap::OcTree* Explorer::tree() const {
  return exploration_ ? &exploration_->mapping().tree() : nullptr;
}
