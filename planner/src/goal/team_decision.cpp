#include "goal/cluster_goal.hpp"
#include "goal/nearest_goal.hpp"
#include "goal/possible_goals.hpp"
#include "goal/rendered_goal.hpp"
#include "goal/seen_targets.hpp"
#include "goal/team_state.hpp"
#include "goal/viewpoint_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::GoalQuery;
using Keys = std::vector<VoxelKey>;

Keys without(const Keys& keys, const Keys& left_out) {
  Keys rest;
  std::set_difference(keys.begin(), keys.end(), left_out.begin(), left_out.end(), std::back_inserter(rest));
  return rest;
}

Keys both(const Keys& a, const Keys& b) {
  Keys all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

Keys picked(const Keys& keys, std::span<const std::uint32_t> indices) {
  Keys some;
  some.reserve(indices.size());
  for (const std::uint32_t i : indices) some.push_back(keys[i]);
  return some;
}

std::string counted(std::size_t frontiers) {
  return std::to_string(frontiers) + (frontiers == 1 ? " frontier" : " frontiers");
}

}  // namespace

GoalQuery GoalSelection::State::query(const RayCaster& caster, std::size_t robot,
                                      std::span<const VoxelKey> targets) const {
  const Member& member = members[robot];
  return {caster,          lattice, member.corridor, team[robot].robot.view, team[robot].options,
          member.position, targets};
}

std::optional<RenderedCell> GoalSelection::State::choose(const RayCaster& caster, const VoxelGrid& grid,
                                                         std::size_t robot, const Keys& targets) {
  Member& member = members[robot];
  member.targets = targets;
  member.rendered = false;
  const GoalQuery asked = query(caster, robot, member.targets);
  switch (team[robot].options.rule) {
    case GoalRule::kClusters:
      return detail::find_cluster_goal(asked);
    case GoalRule::kNearest:
      return detail::find_nearest_goal(asked);
    case GoalRule::kViewQuality:
      break;
  }
  return render(asked, grid, member);
}

std::optional<RenderedCell> GoalSelection::State::render(const GoalQuery& query, const VoxelGrid& grid,
                                                         Member& member) const {
  const double resolution = lattice.resolution();
  const int stride = std::max(1, static_cast<int>(std::lround(query.options.viewpoint_spacing / resolution)));
  Keys viewpoints = detail::viewpoint_cells(query.corridor.cells(), stride, member.cell,
                                            stride * query.options.surroundings);
  std::optional<RenderedCell> counted;
  if (query.options.prune && query.options.refined > 0) {
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

GoalSelection::State::Keys GoalSelection::State::seen_by(const RayCaster& caster, const VoxelGrid& grid,
                                                         std::size_t robot, const Keys& frontiers) const {
  const FrontierAgent agent{members[robot].corridor.cells(), team[robot].robot.view};
  return picked(frontiers, find_visible_frontiers(caster, grid, frontiers, agent).frontiers);
}

// Alg. 1, line 4.
void GoalSelection::State::distribute(const RayCaster& caster, const VoxelGrid& grid, const Keys& frontiers,
                                      TeamGoals& result) {
  std::vector<FrontierAgent> agents;
  for (std::size_t r = 0; r < members.size(); ++r)
    agents.push_back(
        {members[r].corridor.cells(), team[r].robot.view, members[r].sights, members[r].unseen.keys()});
  if (distributes) {
    const FrontierAssignment distribution = assign_frontiers(caster, grid, frontiers, agents);
    Keys left = frontiers;
    for (std::size_t r = 0; r < members.size(); ++r) {
      const AssignedFrontiers& share = distribution.assigned[r];
      members[r].share = picked(frontiers, share.frontiers);
      left = without(left, members[r].share);
      members[r].unseen.set(left);
      members[r].sights.clear();
      for (std::size_t i = 0; i < share.frontiers.size(); ++i)
        members[r].sights.push_back({members[r].share[i], share.seen_from[i]});
    }
    result.unassigned = distribution.unassigned.size();
  } else {
    Keys anyones;
    for (std::size_t r = 0; r < members.size(); ++r) {
      members[r].share = seen_by(caster, grid, r, frontiers);
      anyones = both(anyones, members[r].share);
    }
    result.unassigned = frontiers.size() - anyones.size();
  }
  for (std::size_t r = 0; r < members.size(); ++r) result.goals[r].assigned = members[r].share.size();
}

void GoalSelection::State::set_goal(Goal& goal, std::size_t robot, const RenderedCell& best) const {
  goal.cell = best.cell;
  goal.distance = best.distance;
  goal.gain = best.gain;
  goal.standard_error = best.standard_error;
  goal.quality = best.quality;
  const Eigen::Vector3d center(lattice.center(best.cell.x), lattice.center(best.cell.y),
                               lattice.center(best.cell.z));
  // Who sees all around may look where it is going.
  const bool all_around = team[robot].robot.view.shape == FieldOfView::Shape::kSpinning;
  goal.pose = Pose{center, all_around ? GoalQuery::yaw_along(center - members[robot].position) : best.yaw};
}

// Alg. 1, line 5, and what to do when it finds nothing.
void GoalSelection::State::decide(const RayCaster& caster, const VoxelGrid& grid, TeamGoals& result) {
  std::vector<bool> pending;
  for (std::size_t r = 0; r < members.size(); ++r) pending.push_back(can_move(r));
  // A robot gives up a frontier once at most, so this ends.
  for (;;) {
    const auto next = std::find(pending.begin(), pending.end(), true);
    if (next == pending.end()) break;
    *next = false;
    decide_one(caster, grid, static_cast<std::size_t>(next - pending.begin()), result, pending);
  }
  for (std::size_t r = 0; r < members.size(); ++r)
    if (can_move(r) && !result.goals[r].pose) take_left_over(caster, grid, r, result);
}

void GoalSelection::State::decide_one(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot,
                                      TeamGoals& result, std::vector<bool>& pending) {
  Goal& goal = result.goals[robot];
  const std::size_t count = members[robot].share.size();
  goal.pose.reset();
  if (count == 0) {
    goal.state = GoalState::kNothingAssigned;
    goal.reason = "no goal: none of the frontiers is its";
  } else if (const auto best = choose(caster, grid, robot, members[robot].share)) {
    set_goal(goal, robot, *best);
    goal.state = goal.received == 0 ? GoalState::kOwn : GoalState::kReleased;
    goal.reason = "goal for " + counted(count) + " of its own" +
                  (goal.received == 0 ? "" : ", of which others released " + std::to_string(goal.received));
  } else {
    goal.state = GoalState::kNothingVisible;
    const std::size_t taken = release(caster, grid, robot, result, pending);
    goal.reason = "no goal: its best gain is zero, so it releases " + counted(count) +
                  ", of which others take " + std::to_string(taken);
  }
}

// Gives a robot's frontiers to the others, in their order. Returns how many are taken.
std::size_t GoalSelection::State::release(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot,
                                          TeamGoals& result, std::vector<bool>& pending) {
  Member& member = members[robot];
  const Keys released = std::exchange(member.share, {});
  member.abandoned = both(member.abandoned, released);
  result.goals[robot].released += released.size();
  Keys taken;
  for (std::size_t other = 0; other < members.size(); ++other) {
    if (other == robot || !can_move(other)) continue;
    const Keys offered = without(without(released, taken), members[other].abandoned);
    const Keys accepted = seen_by(caster, grid, other, offered);
    if (accepted.empty()) continue;
    members[other].share = both(members[other].share, accepted);
    result.goals[other].received += accepted.size();
    pending[other] = true;
    taken = both(taken, accepted);
  }
  result.unassigned += released.size() - taken.size();
  return taken.size();
}

void GoalSelection::State::take_left_over(const RayCaster& caster, const VoxelGrid& grid, std::size_t robot,
                                          TeamGoals& result) {
  Keys left;
  for (std::size_t other = 0; other < members.size(); ++other) {
    const Goal& goal = result.goals[other];
    if (other == robot || !goal.pose || goal.state == GoalState::kLeftOver) continue;
    const Keys& share = members[other].share;
    const auto visible = detail::seen_targets(query(caster, other, share), goal.cell, goal.pose->yaw);
    Keys unseen;
    for (std::size_t i = 0; i < share.size(); ++i)
      if (visible[i] == 0) unseen.push_back(share[i]);
    left = both(left, unseen);
  }
  left = seen_by(caster, grid, robot, without(left, members[robot].abandoned));
  Goal& goal = result.goals[robot];
  if (left.empty()) {
    goal.reason += "; and others leave nothing that it sees";
    return;
  }
  const auto best = choose(caster, grid, robot, left);
  if (!best) {
    goal.reason += "; and of " + counted(left.size()) + " that others leave it sees none";
    return;
  }
  set_goal(goal, robot, *best);
  goal.left_over = left.size();
  goal.state = GoalState::kLeftOver;
  goal.reason = "goal for " + counted(left.size()) + " of others that their goals do not see";
}

}  // namespace frontlux::planner
