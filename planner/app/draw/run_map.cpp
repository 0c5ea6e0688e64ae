#include "draw/run_map.hpp"

#include "draw/counts_seconds.hpp"
#include "text.hpp"

#include <algorithm>
#include <cstdint>

namespace frontlux::app {

RunMap::RunMap(const planner::Recording& recording)
    : recording_(recording),
      seconds_(counts_seconds(recording)),
      grid_(recording.head.resolution),
      finished_(recording.head.robots.size()),
      lengths_(finished_.size()) {
  finish_step();
  moment_ = end_of(0);
  paths_ = finished_;
}

double RunMap::end_of(std::size_t step) const {
  const planner::ExplorationStep& of = recording_.steps[step].step;
  return seconds_ ? of.time : static_cast<double>(of.number);
}

double RunMap::end() const { return end_of(recording_.steps.size() - 1); }

void RunMap::finish_step() {
  const planner::ExplorationStep& step = recording_.steps[done_++].step;
  for (std::size_t r = 0; r < step.robots.size(); ++r) {
    const planner::RobotStep& robot = step.robots[r];
    for (const planner::VoxelChange& change : robot.changed) grid_.set(change.key, change.after);
    for (std::size_t i = 0; i < std::min(robot.travelled, robot.planned.size()); ++i)
      finished_[r].push_back(robot.planned[i].position / recording_.head.resolution);
    lengths_[r] += robot.length;
  }
}

void RunMap::go_to(double moment) {
  while (!at_end() && end_of(done_) <= moment) finish_step();
  moment_ = std::min(moment, end());
  paths_ = finished_;
  if (at_end()) return;
  const double begin = end_of(done_ - 1), whole = end_of(done_) - begin;
  const double part = std::clamp((moment_ - begin) / whole, 0.0, 1.0);
  const planner::ExplorationStep& step = recording_.steps[done_].step;
  for (std::size_t r = 0; r < step.robots.size(); ++r) {
    const planner::RobotStep& robot = step.robots[r];
    const std::size_t count = std::min(robot.travelled, robot.planned.size());
    if (count < 2) continue;
    const double reached = part * static_cast<double>(count - 1);
    const auto last = static_cast<std::size_t>(reached);
    const auto at = [&](std::size_t i) -> Eigen::Vector3d {
      return robot.planned[i].position / recording_.head.resolution;
    };
    for (std::size_t i = 0; i <= last; ++i) paths_[r].push_back(at(i));
    if (last + 1 < count)
      paths_[r].push_back(at(last) + (reached - static_cast<double>(last)) * (at(last + 1) - at(last)));
  }
}

std::string RunMap::title(const std::string& name) const {
  const std::string& world = recording_.head.world;
  const std::string begin = name == world ? name + ": " : name + ": " + world + ", ";
  const std::string when = seconds_ ? fixed(moment_, 1) + " s" : "step " + fixed(moment_, 0);
  std::uint64_t known = 0;
  for (const planner::KnownVoxels& part : recording_.steps[done_ - 1].known) known += part.observable;
  const auto total = static_cast<double>(recording_.head.observable);
  if (total == 0.0) return begin + "after " + when;
  return begin + percent(static_cast<double>(known) / total, 1) + " mapped after " + when;
}

}  // namespace frontlux::app
