#include "explored_run.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/sensor.hpp>
#include <frontlux/sim/start_pose.hpp>
#include <frontlux/sim/surface.hpp>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace frontlux::test {
namespace {

using planner::Pose;

constexpr double kResolution = 0.3;

// Counts what each robot makes known first.
class Knowledge {
 public:
  Knowledge(const sim::GroundTruth& truth, std::size_t robots) : truth_(truth), known_(robots) {}

  const std::vector<planner::KnownVoxels>& after(const planner::ExplorationStep& step) {
    for (std::size_t r = 0; r < step.robots.size(); ++r)
      for (const planner::VoxelChange& change : step.robots[r].changed) {
        if (change.before != Occupancy::kUnknown || !seen_.insert(change.key).second) continue;
        ++known_[r].bounding;
        if (truth_.contains(change.key)) ++known_[r].observable;
      }
    return known_;
  }

 private:
  const sim::GroundTruth& truth_;
  std::set<VoxelKey> seen_;
  std::vector<planner::KnownVoxels> known_;
};

}  // namespace

planner::Recording explored_run(const std::string& world_name, int steps, bool uav_alone) {
  const sim::World world = sim::make_world(world_name, 1);
  const Eigen::Vector3d around = sim::free_start(world, kResolution, true);
  const sim::GroundTruth truth(world, kResolution, around);
  const sim::Surface surface(world.mesh);
  const Pose ugv = sim::find_ugv_start(truth, around).value();
  const Pose uav = sim::find_uav_start(truth, around, ugv).value();
  planner::Recording recording;
  planner::RecordingHead& head = recording.head;
  head.world = world_name;
  head.resolution = kResolution;
  head.bounds = truth.bounds();
  head.observable = truth.observable_voxels();
  head.bounding = truth.bounding_voxels();
  head.options = R"({"seed": 1, "mode": "default", "path": {"spacing_m": 1.2}})";
  planner::ExplorationOptions options;
  std::vector<sim::Sensor> sensors;
  const auto join = [&](const planner::Robot& robot, sim::Robot kind, const Pose& start, sim::Sensor sensor) {
    head.robots.push_back({robot, sensor.columns(), sensor.rows()});
    head.starts.push_back({start, sim::start_bubble(truth, kind, start)});
    options.team.push_back({robot, planner::goal_options(robot)});
    sensors.push_back(std::move(sensor));
  };
  if (!uav_alone) join(planner::ugv(), sim::Robot::kUgv, ugv, sim::lidar());
  join(planner::uav(), sim::Robot::kUav, uav, sim::depth_camera());

  Knowledge knowledge(truth, head.robots.size());
  const auto record = [&](planner::ExplorationStep step) {
    const auto& known = knowledge.after(step);
    recording.steps.push_back({std::move(step), known, 0});
  };
  const planner::Drive drive = [&](std::size_t robot, const Pose& at) {
    return std::optional(sim::sense(surface, sensors[robot], at, 1));
  };
  planner::Exploration exploration(options,
                                   planner::Mapping({.resolution = kResolution, .bounds = truth.bounds()}));
  record(exploration.begin(head.starts, drive));
  while (!exploration.end() && std::cmp_less(recording.steps.size(), steps)) record(exploration.step(drive));
  recording.end = exploration.end() ? name_of(*exploration.end()) : "stopped";
  return recording;
}

}  // namespace frontlux::test
