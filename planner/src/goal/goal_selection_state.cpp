#include "goal/goal_selection_state.hpp"

#include "goal/goal_query.hpp"
#include "goal/rendered_cell.hpp"
#include "goal/viewpoint_candidates.hpp"

#include <frontlux/view_region.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::GoalQuery;
using Keys = std::vector<VoxelKey>;

Keys difference(const Keys& keys, const Keys& without) {
  Keys rest;
  std::set_difference(keys.begin(), keys.end(), without.begin(), without.end(), std::back_inserter(rest));
  return rest;
}

Keys united(const Keys& a, const Keys& b) {
  Keys all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

Keys keys_at(const Keys& keys, std::span<const std::uint32_t> indices) {
  Keys some;
  some.reserve(indices.size());
  for (const std::uint32_t i : indices) some.push_back(keys[i]);
  return some;
}

std::string frontiers_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " frontier" : " frontiers");
}

}  // namespace

void GoalSelection::State::note_change(const MapChange& change) {
  const Keys keys(change.keys.begin(), change.keys.end());
  for (Member& member : members) {
    if (member.lost) continue;
    member.missed = united(member.missed, keys);
    if (member.image.size() > 0) member.changed = united(member.changed, keys);
  }
}

void GoalSelection::State::update_corridor(std::size_t robot, const VoxelGrid& grid, const Pose& pose,
                                           CorridorExtent extent) {
  Member& member = members[robot];
  if (member.lost) return;
  member.rendered = false;  // its cells may be none of the corridor's any more
  member.position = pose.position;
  const Keys missed = std::exchange(member.missed, {});
  const auto cell = lattice.key(member.position);
  if (!cell) {
    renew_corridor(robot);  // without an update it has no cells
    return;
  }
  member.cell = *cell;
  member.corridor.update({grid, missed}, member.cell, extent);
  if (extent == CorridorExtent::kNearby)
    member.unseen.forget();
  else
    member.unseen.update({grid, missed}, member.corridor.cells(),
                         ViewRegion(team[robot].robot.view, lattice.resolution()));
}

void GoalSelection::State::begin_step(std::optional<std::size_t> choosing) {
  for (std::size_t r = 0; r < members.size(); ++r) {
    Member& member = members[r];
    member.assigned.clear();
    member.released.clear();
    if (!choosing || *choosing == r) member.targets.clear();
  }
}

void GoalSelection::State::renew_corridor(std::size_t robot) {
  TravelCorridor renewed(team[robot].robot.travel, lattice, bounds);
  renewed.block(members[robot].corridor.blocked());
  members[robot].corridor = std::move(renewed);
  members[robot].unseen.forget();
}

// From now on it has no cells: what it saw is for the others.
void GoalSelection::State::lose(std::size_t robot) {
  Member& member = members[robot];
  member.lost = true;
  member.rendered = false;
  member.missed = member.changed = {};
  member.goal = {};
  member.assigned.clear();
  member.targets.clear();
  member.previous_viewpoints.clear();
  renew_corridor(robot);
}

// Alg. 1, line 4.
void GoalSelection::State::assign(Step& step, const Keys& frontiers) {
  if (exclusive) {
    std::vector<FrontierAgent> agents;
    for (std::size_t r = 0; r < members.size(); ++r)
      agents.push_back({members[r].corridor.cells(), team[r].robot.view, members[r].previous_viewpoints,
                        members[r].unseen.keys()});
    const FrontierAssignment assignment = assign_frontiers(step.caster, step.grid, frontiers, agents);
    Keys unassigned = frontiers;
    for (std::size_t r = 0; r < members.size(); ++r) {
      Member& member = members[r];
      const AssignedFrontiers& assigned = assignment.assigned[r];
      member.assigned = keys_at(frontiers, assigned.frontiers);
      unassigned = difference(unassigned, member.assigned);
      member.unseen.set(unassigned);
      member.previous_viewpoints.clear();
      for (std::size_t i = 0; i < member.assigned.size(); ++i)
        member.previous_viewpoints.push_back({member.assigned[i], assigned.seen_from[i]});
    }
    step.result.unassigned = unassigned.size();
  } else {
    Keys seen_by_any;
    for (std::size_t r = 0; r < members.size(); ++r) {
      members[r].assigned = seen_by(step, r, frontiers);
      seen_by_any = united(seen_by_any, members[r].assigned);
    }
    step.result.unassigned = frontiers.size() - seen_by_any.size();
  }
  for (std::size_t r = 0; r < members.size(); ++r)
    if (step.chooses(r)) step.result.goals[r].assigned = members[r].assigned.size();
}

GoalSelection::State::Keys GoalSelection::State::seen_by(const Step& step, std::size_t robot,
                                                         const Keys& frontiers) const {
  const FrontierAgent agent{members[robot].corridor.cells(), team[robot].robot.view};
  return keys_at(frontiers, find_visible_frontiers(step.caster, step.grid, frontiers, agent).frontiers);
}

// Alg. 1, line 5, and what follows when a robot sees none of its frontiers.
void GoalSelection::State::decide(Step& step) {
  for (std::size_t r = 0; r < members.size(); ++r) step.pending.push_back(step.chooses(r) && can_move(r));
  // A robot releases a frontier at most once, so this ends.
  for (;;) {
    const auto next = std::find(step.pending.begin(), step.pending.end(), true);
    if (next == step.pending.end()) break;
    *next = false;
    decide(step, static_cast<std::size_t>(next - step.pending.begin()));
  }
  for (std::size_t r = 0; r < members.size(); ++r)
    if (step.chooses(r) && can_move(r) && !step.result.goals[r].pose) take_uncovered(step, r);
}

void GoalSelection::State::decide(Step& step, std::size_t robot) {
  Goal& goal = step.result.goals[robot];
  const std::size_t count = members[robot].assigned.size();
  goal.pose.reset();
  if (count == 0) {
    goal.state = GoalState::kNothingAssigned;
    goal.reason = "no goal: no frontiers are assigned to the robot";
  } else if (const auto best = choose(step, robot, members[robot].assigned)) {
    set_goal(goal, robot, *best);
    goal.state = goal.received == 0 ? GoalState::kAssigned : GoalState::kReceived;
    goal.reason = "goal for " + frontiers_text(count);
    if (goal.received != 0)
      goal.reason += ", " + std::to_string(goal.received) + " of them received from other robots";
  } else {
    goal.state = GoalState::kNothingVisible;
    const std::size_t taken = release(step, robot);
    goal.reason = "no goal: the best gain is zero; the robot releases " + frontiers_text(count) +
                  ", other robots take " + std::to_string(taken);
  }
}

std::optional<RenderedCell> GoalSelection::State::choose(const Step& step, std::size_t robot,
                                                         const Keys& targets) {
  Member& member = members[robot];
  member.targets = targets;
  member.rendered = false;
  const GoalQuery goal_query = query(step.caster, robot, member.targets);
  switch (goal_query.options.rule) {
    case GoalRule::kClusters:
      return detail::find_cluster_goal(goal_query);
    case GoalRule::kNearest:
      return detail::find_nearest_goal(goal_query);
    case GoalRule::kViewQuality:
      break;
  }
  return render(goal_query, step.grid, member);
}

GoalQuery GoalSelection::State::query(const RayCaster& caster, std::size_t robot,
                                      std::span<const VoxelKey> targets) const {
  return {caster,
          lattice,
          members[robot].corridor,
          team[robot].robot.view,
          team[robot].options,
          members[robot].position,
          targets};
}

std::optional<RenderedCell> GoalSelection::State::render(const GoalQuery& query, const VoxelGrid& grid,
                                                         Member& member) const {
  const GoalOptions& options = query.options;
  const int stride =
      std::max(1, static_cast<int>(std::lround(options.viewpoint_spacing / lattice.resolution())));
  Keys viewpoints =
      detail::spaced_cells(query.corridor.cells(), stride, member.cell, stride * options.surroundings);
  std::optional<RenderedCell> counted;
  if (options.prune && options.refined > 0) {
    detail::PossibleGoals possible = detail::possible_goals(query, viewpoints);
    viewpoints = std::move(possible.cells);
    counted = possible.counted;
  }
  member.image.update(query.caster, viewpoints, query.targets, {grid, member.changed});
  member.changed.clear();
  member.rendered = true;
  const std::optional<RenderedCell> best = detail::best_cell(query, member.image);
  return counted && (!best || detail::better(query, *counted, *best)) ? counted : best;
}

// Offers a robot's frontiers to the others, in their order. Returns how many they take.
std::size_t GoalSelection::State::release(Step& step, std::size_t robot) {
  Member& member = members[robot];
  const Keys released = std::exchange(member.assigned, {});
  member.released = united(member.released, released);
  step.result.goals[robot].released += released.size();
  Keys taken;
  for (std::size_t other = 0; other < members.size(); ++other) {
    if (other == robot || !can_move(other)) continue;
    const Keys offered = difference(difference(released, taken), members[other].released);
    const Keys accepted = seen_by(step, other, offered);
    if (accepted.empty()) continue;
    members[other].assigned = united(members[other].assigned, accepted);
    if (step.chooses(other)) {
      step.result.goals[other].received += accepted.size();
      step.pending[other] = true;
    }
    taken = united(taken, accepted);
  }
  step.result.unassigned += released.size() - taken.size();
  return taken.size();
}

// For a robot without a goal: the frontiers of the others that their goals do not see.
void GoalSelection::State::take_uncovered(Step& step, std::size_t robot) {
  Keys uncovered;
  for (std::size_t other = 0; other < members.size(); ++other) {
    const Goal& goal = step.result.goals[other];
    if (other == robot || !goal.pose || goal.state == GoalState::kUncovered) continue;
    const Keys& assigned = members[other].assigned;
    const auto visible = query(step.caster, other, assigned).visible_targets(goal.cell, goal.pose->yaw);
    Keys invisible;
    for (std::size_t i = 0; i < assigned.size(); ++i)
      if (visible[i] == 0) invisible.push_back(assigned[i]);
    uncovered = united(uncovered, invisible);
  }
  uncovered = seen_by(step, robot, difference(uncovered, members[robot].released));
  Goal& goal = step.result.goals[robot];
  if (uncovered.empty()) {
    goal.reason += "; it sees no frontiers that the goals of other robots do not see";
    return;
  }
  const std::string count = frontiers_text(uncovered.size());
  if (const auto best = choose(step, robot, uncovered)) {
    set_goal(goal, robot, *best);
    goal.uncovered = uncovered.size();
    goal.state = GoalState::kUncovered;
    goal.reason = "goal for " + count + " of other robots that their goals do not see";
  } else {
    goal.reason += "; the best gain for " + count + " of other robots is zero, too";
  }
}

void GoalSelection::State::set_goal(Goal& goal, std::size_t robot, const RenderedCell& best) const {
  goal.cell = best.cell;
  goal.distance = best.distance;
  goal.gain = best.gain;
  goal.standard_error = best.standard_error;
  goal.quality = best.quality;
  const Eigen::Vector3d place = members[robot].corridor.place_in(best.cell);
  // A robot that sees all around looks where it goes.
  goal.pose =
      Pose{place,
           team[robot].robot.view.sees_all_around() ? yaw_along(place - members[robot].position) : best.yaw};
}

}  // namespace frontlux::planner
