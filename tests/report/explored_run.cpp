#include "report/explored_run.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/simulated_robots.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace frontlux::test {
namespace {

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
  planner::Recording recording;
  planner::RecordingHead& head = recording.head;
  head.world = world_name;
  head.resolution = kResolution;
  head.bounds = truth.bounds();
  head.observable = truth.observable_voxels();
  head.bounding = truth.bounding_voxels();
  head.options = R"({"seed": 1, "mode": "default", "path": {"spacing_m": 1.2}})";
  if (!uav_alone) head.robots.push_back(planner::ugv_description());
  head.robots.push_back(planner::uav_description());
  std::vector<planner::Robot> robots;
  planner::ExplorationOptions options;
  for (const planner::RobotDescription& description : head.robots) {
    robots.push_back(description.robot);
    options.team.push_back({description.robot, planner::goal_options(description.robot)});
  }
  const auto starts = sim::find_starts(truth, around, robots);
  for (std::size_t r = 0; r < robots.size(); ++r)
    head.starts.push_back({starts[r].value(), sim::start_bubble(truth, robots[r], starts[r].value())});

  Knowledge knowledge(truth, head.robots.size());
  sim::SimulatedRobots simulated(world, truth, head.robots, {}, 1);
  std::uint64_t collisions = 0;
  const auto record = [&](planner::ExplorationStep step) {
    const auto& known = knowledge.after(step);
    recording.steps.push_back({std::move(step), known, simulated.total().physical - collisions});
    collisions = simulated.total().physical;
  };
  const planner::Drive drive = [&](std::size_t robot, const planner::Pose& at) {
    return simulated.drive(robot, at);
  };
  planner::Exploration exploration(options,
                                   planner::Mapping({.resolution = kResolution, .bounds = truth.bounds()}));
  record(exploration.begin(head.starts, drive));
  while (!exploration.end() && std::cmp_less(recording.steps.size(), steps)) record(exploration.step(drive));
  recording.end = exploration.end() ? name_of(*exploration.end()) : "stopped";
  return recording;
}

}  // namespace frontlux::test
