#include "exploration/exploration_state.hpp"
#include "exploration/path_execution.hpp"

#include <algorithm>
#include <utility>

// Alg. 1, lines 8 to 11: the robots go, and the map learns.
namespace frontlux::planner {
namespace {

// Targets in view from where the robot has been, first place left out, that are unknown still.
std::vector<VoxelKey> still_unknown(const VoxelGrid& grid, const InformationGain& gain,
                                    std::span<const Pose> viewpoints, std::span<const VoxelKey> targets) {
  std::vector<VoxelKey> keys;
  std::vector<std::uint8_t> in_view;
  for (std::size_t i = 1; i < viewpoints.size(); ++i) {
    const auto seen = gain.frontiers_of(i);
    in_view.resize(seen.size());
    gain.in_view(i, viewpoints[i].yaw, in_view);
    for (std::size_t k = 0; k < seen.size(); ++k)
      if (in_view[k] != 0 && grid.at(targets[seen[k]]) == Occupancy::kUnknown)
        keys.push_back(targets[seen[k]]);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

}  // namespace

// Lines 8 to 11.
void Exploration::State::go(std::size_t robot, const Plan& plan, const Drive& drive, RobotStep& step) {
  TravelOptions body = options.team[robot].robot.travel;
  body.node_edge = 0.0;
  // The way back is that on which it came.
  detail::PathExecution journey =
      detail::travel(robot, step.planned, step.goal.pose ? &body : nullptr, drive, mapping);
  step.travelled = journey.travelled;
  step.length = journey.length;
  step.changed = std::move(journey.changed);
  step.blocked = std::move(journey.blocked);
  step.gained = static_cast<std::uint64_t>(
      std::count_if(step.changed.begin(), step.changed.end(), [&](const VoxelChange& change) {
        return change.before == Occupancy::kUnknown && frontiers.contains(change.key);
      }));
  // A look at what is in the way is not from where the path would have led.
  const std::size_t reached = step.travelled - (step.blocked.empty() ? 0 : 1);
  if (plan.gain)
    step.still_unknown = still_unknown(mapping.grid(), *plan.gain,
                                       std::span<const Pose>(step.planned).first(reached), plan.targets);
}

// What a robot's part of a step leaves behind.
void Exploration::State::take(const RobotStep& step, std::size_t robot) {
  abandoned.visited(step.still_unknown);
  if (!step.blocked.empty()) {
    selection->block(robot, step.blocked);
    if (ways[robot]) ways[robot]->block(step.blocked);
  }
  for (std::size_t i = trails[robot].empty() ? 0 : 1; i < step.travelled; ++i)
    trails[robot].push_back(step.planned[i]);
  if (step.travelled > 0) poses[robot] = step.planned[step.travelled - 1];
}

// Brings the frontiers up to date with what the robots changed.
void Exploration::State::follow(const ExplorationStep& step) {
  changed.clear();
  for (const RobotStep& robot : step.robots)
    for (const VoxelChange& voxel : robot.changed) changed.push_back(voxel.key);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  frontiers.update(change());
}

}  // namespace frontlux::planner
