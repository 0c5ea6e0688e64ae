#pragma once

#include "planner/exploration/team_in_world.hpp"

#include <frontlux/planner/continuous_exploration.hpp>
#include <frontlux/sim/coverage.hpp>
#include <frontlux/sim/moving_robots.hpp>

#include <array>
#include <functional>
#include <string>

namespace frontlux::test {

/// A UAV with few pixels.
inline planner::RobotDescription small_uav() {
  planner::RobotDescription robot = planner::uav_description();
  robot.columns = 60;
  robot.rows = 40;
  robot.rate = 10.0;
  return robot;
}

/// How goals are chosen: one after the other; by tours; by tours, in a map that may grow so large that robots
/// know distances near by only.
enum class GoalChoice { kGoals, kTours, kToursInALargeMap };
inline constexpr std::array kGoalChoices = {GoalChoice::kGoals, GoalChoice::kTours,
                                            GoalChoice::kToursInALargeMap};
inline std::string name_of_choice(const testing::TestParamInfo<GoalChoice>& now) {
  if (now.param == GoalChoice::kGoals) return "Goals";
  return now.param == GoalChoice::kTours ? "Tours" : "ToursInALargeMap";
}

/// The part of what robots can observe that a map knows.
inline double share_mapped(const TeamInWorld& team, const VoxelGrid& grid) {
  return sim::measure(team.truth, grid).of_observable();
}

/// The voxels that a body at a position is in, but for those that it only touches.
inline KeyBox voxels_at(const planner::TravelOptions& travel, const Lattice& lattice,
                        const Eigen::Vector3d& position) {
  const Eigen::Vector3d half = travel.box() / 2 - Eigen::Vector3d::Constant(1e-4 * lattice.resolution());
  return planner::voxels_of(lattice, {position - half, position + half});
}

/// A team that explores a world in motion.
class TeamInMotion {
 public:
  /// Called after each planning.
  using Planned = std::function<void(const planner::PlannedMotion&)>;
  /// Called with the time of a scan [s] before the robots move there.
  using Moves = std::function<void(double from, double to)>;

  TeamInMotion(std::string_view world, std::vector<planner::RobotDescription> robots,
               sim::AtContact at_contact = sim::AtContact::kGoOn, GoalChoice choice = GoalChoice::kGoals)
      : TeamInMotion(TeamInWorld(world, 1, std::move(robots)), at_contact, choice) {}
  /// @param epsilon  see `ExplorationOptions`
  TeamInMotion(TeamInWorld team, sim::AtContact at_contact, GoalChoice choice, double epsilon = 10.0)
      : team_(std::move(team)),
        robots_(team_.world, team_.truth, team_.robots, poses_of(team_), {}, 1, at_contact),
        exploration_(options(team_, choice, epsilon), empty_map(team_, choice)) {
    steps.push_back(exploration_.begin(team_.starts, 0.0));
  }

  /// Until this time [s] or its end.
  void explore(double until, const Planned& planned = {}, const Moves& moves = {}) {
    while (!exploration_.end() && robots_.next_time() <= until) {
      const double next = robots_.next_time();
      if (next > time_) {
        while (auto now = exploration_.plan(time_)) {
          if (planned) planned(*now);
          steps.push_back(std::move(now->step));
          if (exploration_.end()) return;
        }
        if (moves) moves(time_, next);
      }
      std::vector<sim::MovingRobots::Stopped> stopped;
      const auto sensed =
          robots_.advance([this](std::size_t r, double t) { return exploration_.at(r, t); }, stopped);
      time_ = next;
      for (const auto& robot : stopped) exploration_.stopped(robot.robot, robot.pose, time_, robot.blocked);
      exploration_.insert(sensed.robot, sensed.pose, sensed.scan);
    }
  }

  static planner::ExplorationOptions options(const TeamInWorld& team, GoalChoice choice = GoalChoice::kGoals,
                                             double epsilon = 10.0) {
    planner::ExplorationOptions options = team.options();
    options.epsilon = epsilon;
    options.tours = choice != GoalChoice::kGoals;
    for (planner::TeamMember& member : options.team) member.options.advance = 2.0;
    return options;
  }

  [[nodiscard]] const TeamInWorld& team() const { return team_; }
  [[nodiscard]] const sim::MovingRobots& robots() const { return robots_; }
  [[nodiscard]] planner::ContinuousExploration& exploration() { return exploration_; }
  [[nodiscard]] double time() const { return time_; }  ///< [s] of the last scan
  [[nodiscard]] VoxelGrid grid() const { return exploration_.mapping().grid(); }

  std::vector<ExplorationStep> steps;

 private:
  static planner::Mapping empty_map(const TeamInWorld& team, GoalChoice choice) {
    KeyBox bounds = team.truth.bounds();
    if (choice == GoalChoice::kToursInALargeMap) bounds = grown(bounds, 45);
    return planner::Mapping({.resolution = 0.3, .bounds = bounds});
  }
  static std::vector<Pose> poses_of(const TeamInWorld& team) {
    std::vector<Pose> poses;
    for (const auto& start : team.starts) poses.push_back(start.pose);
    return poses;
  }

  TeamInWorld team_;
  sim::MovingRobots robots_;
  planner::ContinuousExploration exploration_;
  double time_ = 0.0;
};

}  // namespace frontlux::test
