// The trajectory that a robot takes next: to its goal, back, or to rest, apart from the others.

#include "corridor/floor_below.hpp"
#include "exploration/continuous_state.hpp"
#include "exploration/frontiers_in_view.hpp"
#include "exploration/phase_clock.hpp"
#include "mapping/sort_once.hpp"
#include "motion/departure.hpp"

#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::sort_once;
using Keys = std::vector<VoxelKey>;

}  // namespace

bool ContinuousExploration::State::keeps_apart(std::size_t robot, const Trajectory& trajectory, double from,
                                               std::size_t other) const {
  const auto body = [&](std::size_t r) { return body_of(team.options.team[r].robot.travel); };
  const auto speed = [&](std::size_t r) { return team.options.team[r].robot.limits.speed; };
  return detail::keeps_apart(trajectory, from, body(robot), members[other].motion, body(other), kSeparation,
                             speed(robot) + speed(other));
}

bool ContinuousExploration::State::keeps_apart(std::size_t robot, const Trajectory& trajectory) const {
  for (std::size_t other = 0; other < members.size(); ++other)
    if (other != robot && !keeps_apart(robot, trajectory, trajectory.begin(), other)) return false;
  return true;
}

SegmentTest ContinuousExploration::State::segment_test(std::size_t robot) const {
  const TravelCorridor& corridor = team.path_corridor(robot);
  return [this, &corridor](const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                           const Eigen::Vector3d& deviation) {
    return segment_is_free(corridor, team.lattice(), from, to, deviation);
  };
}

// The cells through which a robot goes from a time [s] on; sorted. A retreat need not be free for the body,
// since the robot came on it, but may not be shut.
Keys ContinuousExploration::State::cells_on(const BodyStencil& stencil, const Trajectory& trajectory,
                                            double since, bool retreats) const {
  constexpr double kStep = 0.05;  // [s]
  const Eigen::Vector3d reach = retreats ? Eigen::Vector3d::Zero() : stencil.reach();
  Keys cells;
  // Where it has arrived it is still in the last one.
  const double begin = std::max(trajectory.begin(), std::min(since, trajectory.end() - kStep));
  Eigen::Vector3d from = trajectory.at(begin).pose.position;
  for (double time = begin; time < trajectory.end(); time += kStep) {
    const Eigen::Vector3d to = trajectory.at(time + kStep).pose.position;
    // Between its cells' middles a body touches voxels that are none of its own cell's.
    SegmentVoxels(team.lattice(), from, to, reach).for_each([&](const VoxelKey& key) {
      if (cells.empty() || cells.back() != key) cells.push_back(key);
    });
    from = to;
  }
  sort_once(cells);
  return cells;
}

// What has to stay free for a trajectory, sorted.
// @param floor  learns what must not become a hole: the floor below, as far as it is not known to be free
Keys ContinuousExploration::State::voxels_needed(std::size_t robot, const Trajectory& trajectory,
                                                 Keys& floor) const {
  const BodyStencil& stencil = team.path_corridor(robot).stencil();
  const bool retreats = members[robot].activity == Activity::kRetreats;
  Keys cells = cells_on(stencil, trajectory, trajectory.begin(), retreats);
  floor.clear();
  if (retreats) return team.fills_its_voxel(robot) ? cells : Keys{};
  Keys voxels;
  for (const VoxelKey& cell : cells)
    stencil.for_each(cell, [&](const VoxelKey& key) {
      if (team.mapping.grid().at(key) == Occupancy::kFree) voxels.push_back(key);
    });
  sort_once(voxels);
  const detail::FloorBelow below(team.options.team[robot].robot.travel, team.lattice().resolution());
  for (const VoxelKey& cell : cells)
    below.for_each(cell, [&](const VoxelKey& key) {
      if (team.mapping.grid().at(key) != Occupancy::kFree) floor.push_back(key);
    });
  sort_once(floor);
  return voxels;
}

// What has been closed behind a robot does not stop it.
void ContinuousExploration::State::look_for_blocked(double time) {
  for (std::size_t r = 0; r < members.size(); ++r) {
    Member& member = members[r];
    const Keys closed = std::exchange(member.closed, {});
    const Keys opened = std::exchange(member.opened, {});
    if ((closed.empty() && opened.empty()) || member.blocked) continue;
    const detail::FloorBelow below(team.options.team[r].robot.travel, team.lattice().resolution());
    Keys holes;
    for (const VoxelKey& key : opened)
      below.for_each_hole_near(team.mapping.grid(), key,
                               [&](const VoxelKey& hole) { holes.push_back(hole); });
    sort_once(holes);
    const BodyStencil& stencil = team.path_corridor(r).stencil();
    const bool retreats = member.activity == Activity::kRetreats;
    const auto needs = [&](const VoxelKey& cell) {
      return std::ranges::any_of(
                 closed,
                 [&](const VoxelKey& key) { return retreats ? cell == key : stencil.contains(cell, key); }) ||
             std::ranges::any_of(holes, [&](const VoxelKey& key) { return below.contains(cell, key); });
    };
    member.blocked = std::ranges::any_of(cells_on(stencil, member.motion.last(), time, retreats), needs);
  }
}

// Off another one's path, or back on the path on which it came, to the last place from which it can go on.
Trajectory ContinuousExploration::State::without_goal(std::size_t robot, double start,
                                                      ExplorationStep& step) {
  Member& member = members[robot];
  RobotStep& now = step.robots[robot];
  const Trajectory& old = member.motion.last();
  const MotionState then = old.at(start);
  member.activity = Activity::kTriesAgain;
  std::vector<Pose> path;
  if (then.velocity.isZero()) {
    ask_for_room(robot, step);
    const detail::PhaseClock clock(step, Phase::kPaths);
    path = path_aside(robot);
    member.activity = Activity::kMakesRoom;
    if (path.empty()) {
      end_request(robot);
      if (!waits_for_room(robot)) path = team.plan_retreat(robot, now.goal);
      member.activity = path.empty() ? Activity::kRests : Activity::kRetreats;
    }
  }
  if (member.activity == Activity::kMakesRoom) now.goal.reason = "no goal: it makes room for another robot";
  if (waits_for_room(robot)) now.goal.reason = "no goal: it waits for another robot to make room";
  if (!path.empty()) {
    path.insert(path.begin(), then.pose);
    now.path = PathOutcome::kFound;
  }
  const detail::PhaseClock clock(step, Phase::kPaths);
  return old.after_stop(start, path, team.options.team[robot].robot.limits, segment_test(robot));
}

// To the robot's goal, or back, or to rest.
Trajectory ContinuousExploration::State::find_trajectory(std::size_t robot, double start,
                                                         ExplorationStep& step) {
  Member& member = members[robot];
  RobotStep& now = step.robots[robot];
  const Trajectory& old = member.motion.last();
  const MotionLimits& limits = team.options.team[robot].robot.limits;
  member.goal_frontiers.clear();
  if (!now.goal.pose) return without_goal(robot, start, step);
  member.request.reset();
  withdraw_requests(robot);
  team.retreated_to[robot].clear();
  const SegmentTest is_free = segment_test(robot);
  std::optional<detail::Departure> departure;
  {
    const detail::PhaseClock clock(step, Phase::kPaths);
    Pose to = *now.goal.pose;
    if (team.ahead[robot]) to.position = team.path_corridor(robot).place_in(*team.ahead[robot]);
    bool found = false;  // a path; that of the departure is one of those found
    const auto path_from = [&](const Pose& from) {
      PathPlan plan = plan_path(team.path_corridor(robot), team.lattice(), from, to,
                                {team.options.seed, team.number, robot}, team.options.path);
      if (!found || !plan.viewpoints.empty()) now.path = plan.outcome;
      found = found || !plan.viewpoints.empty();
      return std::move(plan.viewpoints);
    };
    departure = detail::best_departure(old, start, path_from, limits, is_free);
  }
  if (!departure) {
    member.activity = old.at(start).velocity.isZero() ? Activity::kRests : Activity::kTriesAgain;
    return old.after_stop(start, {}, limits, is_free);
  }
  member.activity = Activity::kMoves;
  const detail::PhaseClock clock(step, Phase::kOptimization);
  std::vector<Pose>& path = departure->viewpoints;
  const InformationGain gain = team.optimize_path(robot, path, step);
  if (team.tours)
    member.goal_frontiers = team.tours->first_view(robot);
  else
    for (const std::uint32_t i : detail::frontiers_in_view(gain, path.size() - 1, path.back().yaw))
      member.goal_frontiers.push_back(team.targets[robot][i]);
  return detail::depart(old, start, *departure, limits, is_free);
}

// Lets a robot follow a trajectory if it keeps apart from the others, else the one that it has.
void ContinuousExploration::State::take_up(std::size_t robot, double start, Trajectory& trajectory,
                                           ExplorationStep& step) {
  const detail::PhaseClock clock(step, Phase::kPaths);
  Member& member = members[robot];
  const bool apart = keeps_apart(robot, trajectory);
  const bool retreats = member.activity == Activity::kRetreats;
  const auto moves = [&](const Member& other) { return other.motion.last().end() > start; };
  // Another one may make room: it tries the retreat again.
  const bool tries_again = !apart && retreats && std::ranges::any_of(members, moves);
  if (tries_again) team.retreated_to[robot].pop_back();
  if (!apart) member.goal_frontiers.clear();  // it does not get there
  if (apart || brakes_instead(robot, start, trajectory)) {
    member.needed = voxels_needed(robot, trajectory, member.floor);
    member.motion.next = trajectory;
    if (!apart) tell_of_stop(robot, start);
    return;
  }
  trajectory = member.motion.last();  // which keeps apart
  member.activity = trajectory.end() > start ? Activity::kMoves
                    : tries_again            ? Activity::kTriesAgain
                                             : Activity::kRests;
}

// Of a robot whose path is neither free nor can be left: it brakes, also on the path of another one, which
// can still get out of its way.
bool ContinuousExploration::State::brakes_instead(std::size_t robot, double start, Trajectory& trajectory) {
  Member& member = members[robot];
  if (!member.blocked && !member.meets_other) return false;
  trajectory = member.motion.last().after_stop(start, {}, team.options.team[robot].robot.limits, {});
  member.activity = Activity::kTriesAgain;
  return true;
}

}  // namespace frontlux::planner
