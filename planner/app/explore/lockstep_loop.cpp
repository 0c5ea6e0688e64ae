#include "explore/lockstep_loop.hpp"

#include <frontlux/planner/trajectory.hpp>

#include <span>

namespace frontlux::app {

using planner::ExplorationStep;

LockstepLoop::LockstepLoop(const ExploreSetup& setup)
    : setup_(setup),
      robots_(setup.sourced.world, *setup.truth, setup.head.robots, setup.errors, setup.exploration.seed,
              setup.at_contact),
      exploration_(setup.exploration, planner::Mapping({.resolution = setup.head.resolution,
                                                        .bounds = setup.head.bounds,
                                                        .sensor_model = setup.sensor_model})) {
  numbers_.mapped.emplace_back();
  numbers_.robots.resize(setup.head.robots.size());
  for (const planner::ExplorationStart& start : setup.head.starts) paths_.emplace_back(start.pose.position);
}

planner::Drive LockstepLoop::drive() {
  return
      [this](std::size_t robot, const planner::Pose& viewpoint) { return robots_.drive(robot, viewpoint); };
}

ExplorationStep LockstepLoop::step() {
  ExplorationStep step =
      begun_ ? exploration_.step(drive()) : exploration_.begin(setup_.head.starts, drive());
  begun_ = true;
  note(step);
  return step;
}

bool LockstepLoop::repeat(const ExplorationStep& recorded) {
  if (begun_) {
    if (!exploration_.repeat(recorded, drive())) return false;
    note(recorded);
    return true;
  }
  const ExplorationStep now = step();
  for (std::size_t r = 0; r < now.robots.size(); ++r)
    if (now.robots[r].changed != recorded.robots[r].changed) return false;
  return true;
}

void LockstepLoop::note(const ExplorationStep& step) {
  const double before = numbers_.mapped.back().time;
  Mapped mapped = numbers_.mapped.back();
  mapped.time = step.time;
  for (std::size_t r = 0; r < step.robots.size(); ++r) {
    const planner::RobotStep& robot = step.robots[r];
    const auto reached = std::span(robot.planned).first(robot.travelled);
    const double moving = planner::stop_and_go_time(reached, setup_.head.robots[r].robot.limits);
    for (const planner::Pose& viewpoint : reached) paths_[r].go_to(viewpoint.position);
    numbers_.robots[r].length += robot.length;
    numbers_.robots[r].revisited = paths_[r].share();
    numbers_.robots[r].idle += step.time - before - moving;
    numbers_.robots[r].held_back += robot.blocked.empty() ? 0 : 1;
    numbers_.robots[r].goal = robot.goal.reason;
    mapped.length += robot.length;
    for (const planner::VoxelChange& change : robot.changed) {
      if (change.before != Occupancy::kUnknown) continue;
      ++mapped.bounding;
      mapped.observable += setup_.truth->contains(change.key) ? 1 : 0;
    }
  }
  numbers_.mapped.push_back(mapped);
  numbers_.contacts = robots_.contacts();
}

std::optional<RunEnd> LockstepLoop::end() const {
  if (!begun_) return std::nullopt;
  if (const auto limit = limit_reached(setup_, numbers_.mapped.back())) return limit;
  const auto end = exploration_.end();
  if (!end) return std::nullopt;
  return RunEnd{std::string(planner::name_of(*end)), planner::describe(*end, exploration_.options())};
}

}  // namespace frontlux::app
