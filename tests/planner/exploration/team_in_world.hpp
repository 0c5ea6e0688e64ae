#pragma once

#include "planner/recording/random_recording.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/simulated_robots.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <octomap/OcTree.h>

#include <string_view>

namespace frontlux::test {

using planner::Exploration;
using planner::ExplorationOptions;
using planner::ExplorationStep;
using planner::Pose;
using planner::RobotStep;

/// A world at 0.3 m, and robots at their starts in it.
struct TeamInWorld {
  sim::World world;
  Eigen::Vector3d around;
  sim::GroundTruth truth;
  std::vector<planner::RobotDescription> robots;
  std::vector<planner::ExplorationStart> starts;

  /// Built-in.
  TeamInWorld(std::string_view name, std::uint64_t seed, std::vector<planner::RobotDescription> team)
      : TeamInWorld(sim::make_world(name, seed), std::move(team)) {}
  TeamInWorld(sim::World place, std::vector<planner::RobotDescription> team)
      : world(std::move(place)),
        around(sim::free_start(world, 0.3, true)),
        truth(world, 0.3, around),
        robots(std::move(team)) {
    std::vector<planner::Robot> bodies;
    for (auto& description : robots) {
      description.robot.travel.floor = sim::ground_below(truth, around);
      bodies.push_back(description.robot);
    }
    const auto poses = sim::find_starts(truth, around, bodies);
    for (std::size_t r = 0; r < poses.size(); ++r) {
      if (!poses[r]) throw std::runtime_error("no start for robot " + std::to_string(r));
      starts.push_back({*poses[r], sim::start_bubble(truth, bodies[r], *poses[r])});
    }
  }

  [[nodiscard]] ExplorationOptions options(planner::Method method = planner::Method::kDefault) const {
    ExplorationOptions options = planner::exploration_options(method);
    for (const auto& description : robots)
      options.team.push_back({description.robot, planner::goal_options(description.robot, method)});
    return options;
  }
  [[nodiscard]] planner::Mapping empty_map() const {
    return planner::Mapping({.resolution = 0.3, .bounds = truth.bounds()});
  }
  [[nodiscard]] sim::SimulatedRobots bodies(sim::AtContact at_contact = sim::AtContact::kGoOn) const {
    return sim::SimulatedRobots(world, truth, robots, {}, 1, at_contact);
  }
};

inline std::vector<planner::RobotDescription> uav_and_ugv() {
  return {planner::ugv_description(), planner::uav_description()};
}

inline planner::Drive drive_by(sim::SimulatedRobots& robots) {
  return [&robots](std::size_t robot, const Pose& viewpoint) { return robots.drive(robot, viewpoint); };
}

/// The bytes of its file.
inline std::string bytes_of(const planner::Mapping& mapping) {
  std::ostringstream bytes;
  mapping.tree().write(bytes);
  return bytes.str();
}

inline bool same(const Pose& a, const Pose& b) { return a.position == b.position && a.yaw == b.yaw; }
inline bool same(std::span<const Pose> a, std::span<const Pose> b) {
  return std::ranges::equal(a, b, [](const Pose& x, const Pose& y) { return same(x, y); });
}

/// All but the times are the same, to the last bit.
inline void expect_same(const ExplorationStep& a, const ExplorationStep& b) {
  EXPECT_TRUE(listed(a) == listed(b))
      << "step " << a.number << ": " << first_difference(listed(a), listed(b));
}

}  // namespace frontlux::test
