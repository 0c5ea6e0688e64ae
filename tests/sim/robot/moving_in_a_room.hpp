#pragma once

#include "sim/mesh/box_mesh.hpp"
#include "support/test.hpp"

#include <frontlux/sim/moving_robots.hpp>

#include <bit>

namespace frontlux::sim {

using Eigen::Vector3d;
using planner::MotionState, planner::Pose, planner::RobotDescription;

// 6 x 6 x 3 m, empty but for what is added.
struct BoxRoom {
  World world;

  BoxRoom() {
    world.name = "box";
    world.mesh = test::box_mesh({Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(6, 6, 3)});
    world.bounds = {Vector3d(0, 0, 0), Vector3d(6, 6, 3)};
  }
  // A wall without thickness across x, from y = 2 m on.
  void add_pane(float x) { test::add_quad(world.mesh, {x, 2, 0}, {x, 6, 0}, {x, 6, 3}, {x, 2, 3}); }
};

// Few rays, and as often as this.
inline RobotDescription small(RobotDescription robot, double rate) {
  robot.columns = 6;
  robot.rows = 4;
  robot.rate = rate;
  return robot;
}
inline RobotDescription uav(double rate = 10.0) { return small(planner::uav_description(), rate); }
inline RobotDescription ugv(double rate = 10.0) { return small(planner::ugv_description(), rate); }

// Robots in a room, with all that their bumpers reported.
struct Moving {
  GroundTruth truth;
  std::vector<Pose> starts;
  MovingRobots robots;
  std::vector<MovingRobots::Stopped> stopped = {};

  Moving(const BoxRoom& room, std::vector<RobotDescription> team, std::vector<Pose> at,
         AtContact at_contact = AtContact::kGoOn, const RangeErrors& errors = {}, std::uint64_t seed = 1,
         const PoseErrors& pose_errors = {})
      : truth(room.world, 0.3, {1.05, 1.05, 1.05}),
        starts(std::move(at)),
        robots(room.world, truth, std::move(team), starts, errors, seed, at_contact, pose_errors) {}

  // Up to the last scan that is not later.
  void go_on(double until, const MovingRobots::Where& where) {
    while (robots.next_time() <= until + 1e-9) robots.advance(where, stopped);
  }
  [[nodiscard]] const MotionRecord& record(std::size_t robot = 0) const { return robots.records()[robot]; }
};

inline MotionState at(const Vector3d& position, double yaw = 0.0) { return {{position, yaw}}; }

// At 1 m/s from one point to another, from a time on.
inline Vector3d on_the_way(const Vector3d& from, const Vector3d& to, double time) {
  const double length = (to - from).norm();
  return from + std::clamp(time / length, 0.0, 1.0) * (to - from);
}

inline bool same_bits(const planner::Scan& a, const planner::Scan& b) {
  return a.origin == b.origin && std::ranges::equal(a.ranges, b.ranges, [](float x, float y) {
           return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
         });
}

}  // namespace frontlux::sim
