#include "made_up_run.hpp"

#include <frontlux/planner/frontier.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/scan_world.hpp>
#include <frontlux/sim/sensor.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace frontlux::test {
namespace {

using planner::Pose;
using planner::RobotStep;

constexpr double kResolution = 0.3;
constexpr std::size_t kViewpoints = 5;  // of a step

// The places of a sweep, each the nearest to the one before, never one twice.
std::vector<Pose> tour(const sim::GroundTruth& truth, sim::Robot robot, const Pose& start) {
  std::vector<sim::View> views = sim::sweep(truth, robot, start, 2.0);
  std::vector<Pose> poses = {start};
  while (!views.empty()) {
    const Eigen::Vector3d here = poses.back().position;
    const auto next = std::min_element(views.begin(), views.end(), [&](const auto& a, const auto& b) {
      return (a.sensor_pose.position - here).squaredNorm() < (b.sensor_pose.position - here).squaredNorm();
    });
    poses.push_back(next->sensor_pose);
    const Eigen::Vector3d way = poses.back().position - here;
    poses.back().yaw = std::atan2(way.y(), way.x());
    views.erase(next);
  }
  return poses;
}

struct Drive {
  planner::Mapping mapping;
  std::map<VoxelKey, Occupancy> states;
  sim::Surface surface;
  std::array<sim::Sensor, 2> sensors = {sim::lidar(), sim::depth_camera()};

  void take(const std::vector<VoxelKey>& keys, std::map<VoxelKey, planner::VoxelChange>& changes) {
    for (const VoxelKey& key : keys) {
      const auto change = changes.try_emplace(key, key, states[key]).first;
      change->second.after = states[key] = mapping.grid().at(key);
    }
  }
};

std::vector<planner::RenderedCell> made_up_image(planner::TravelCorridor& corridor, const VoxelGrid& grid,
                                                 const Pose& pose) {
  const VoxelKey at = grid.lattice().key(Eigen::Vector3f(pose.position.cast<float>())).value();
  corridor.update(grid, {}, at);
  std::vector<planner::RenderedCell> image;
  for (const VoxelKey& cell : corridor.cells()) {
    const double distance = corridor.distance(cell).value();
    const double gain =
        120.0 * (1.0 + std::sin(0.21 * cell.x) * std::cos(0.17 * cell.y)) + (cell.x * 7 + cell.y * 3) % 11;
    image.push_back({cell, distance, gain, 0.0, gain * std::exp(-0.1386 * distance)});
  }
  return image;
}

}  // namespace

planner::Recording made_up_run(const std::string& world_name, int steps) {
  const sim::World world = sim::make_world(world_name, 1);
  const Eigen::Vector3d around = sim::free_start(world, kResolution, true);
  const sim::GroundTruth truth(world, kResolution, around);
  const Pose ugv = sim::find_ugv_start(truth, around).value();
  const Pose uav = sim::find_uav_start(truth, around, ugv).value();
  const std::array<Pose, 2> starts = {ugv, uav};
  const std::array<std::vector<Pose>, 2> tours = {tour(truth, sim::Robot::kUgv, ugv),
                                                  tour(truth, sim::Robot::kUav, uav)};

  planner::Recording recording;
  planner::RecordingHead& head = recording.head;
  head = {world_name,
          kResolution,
          truth.bounds(),
          {planner::ugv_description(), planner::uav_description()},
          {},
          truth.observable_voxels(),
          truth.bounding_voxels(),
          R"({"seed": 1, "mode": "made up", "path": {"spacing_m": 2}})"};
  Drive drive{
      planner::Mapping({.resolution = kResolution, .bounds = truth.bounds()}), {}, sim::Surface(world.mesh)};
  std::map<VoxelKey, std::size_t> owners;
  std::vector<planner::KnownVoxels> known(2);
  std::array<std::size_t, 2> at = {0, 0};
  planner::FrontierSet frontiers(drive.mapping.grid(), truth.bounds());
  for (int number = 0; number < steps; ++number) {
    planner::RecordedStep recorded;
    planner::ExplorationStep& step = recorded.step;
    step.number = static_cast<std::uint64_t>(number);
    step.frontiers = frontiers.size();
    step.unassigned = step.frontiers / 20;
    step.rays = 64 * step.frontiers;
    step.seconds = {
        0.004, 0.011, 0.05 + 1e-5 * static_cast<double>(step.frontiers), 0.02, 0.03 + 0.01 * (number % 7),
        0.9};
    const VoxelGrid before = drive.mapping.grid();
    for (std::size_t r = 0; r < 2; ++r) {
      std::map<VoxelKey, planner::VoxelChange> changes;
      RobotStep robot;
      const auto scan = [&](const Pose& pose, std::uint64_t seed) {
        drive.take(drive.mapping.insert(sim::sense(drive.surface, drive.sensors.at(r), pose, seed)), changes);
      };
      if (number == 0) {
        head.starts.push_back(
            {starts.at(r),
             sim::start_bubble(truth, r == 0 ? sim::Robot::kUgv : sim::Robot::kUav, starts.at(r))});
        drive.take(drive.mapping.mark_free(head.starts.back().known_free), changes);
        for (const sim::View& view :
             r == 0 ? std::vector<sim::View>{{sim::Robot::kUgv, ugv}} : sim::look_around(uav)) {
          robot.planned.push_back(view.sensor_pose);
          scan(view.sensor_pose, 0);
        }
        robot.goal.state = planner::GoalState::kNoFrontiers;
      } else {
        const std::vector<Pose>& places = tours.at(r);
        for (std::size_t i = 0; i < kViewpoints && at.at(r) + i < places.size(); ++i) {
          robot.planned.push_back(places[at.at(r) + i]);
          scan(robot.planned.back(), step.number);
        }
        at.at(r) = std::min(at.at(r) + kViewpoints - 1, places.size() - 1);
        robot.goal.pose = robot.planned.back();
        robot.goal.state = planner::GoalState::kOwn;
        robot.goal.reason = "the place next to the last one";
        robot.goal.gain = 100.5;
        robot.path = planner::PathOutcome::kFound;
        if (r == 0) {
          planner::TravelCorridor corridor(head.robots[0].robot.travel, before.lattice(), truth.bounds());
          robot.image = made_up_image(corridor, before, robot.planned.front());
        }
      }
      robot.travelled = robot.planned.size();
      robot.length = planner::path_length(robot.planned);
      std::vector<VoxelKey> keys;
      for (const auto& [key, change] : changes) {
        if (change.before == change.after) continue;
        robot.changed.push_back(change);
        keys.push_back(key);
        if (change.before == Occupancy::kUnknown && owners.try_emplace(key, r).second) {
          ++known[r].bounding;
          if (truth.contains(key)) ++known[r].observable;
        }
      }
      robot.gained = keys.size() / 10;
      robot.gain_predicted = robot.gained * 3 / 4;
      robot.gain_tangent = robot.gained / 2;
      frontiers.update(drive.mapping.grid(), keys);
      step.robots.push_back(std::move(robot));
    }
    recorded.known = known;
    recording.steps.push_back(std::move(recorded));
  }
  recording.end = "step_limit";
  return recording;
}

}  // namespace frontlux::test
