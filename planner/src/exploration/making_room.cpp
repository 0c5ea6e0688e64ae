// Robots that rest on the paths of others, and make room for them.

#include "casting/counting_ray_caster.hpp"
#include "exploration/continuous_state.hpp"
#include "exploration/phase_clock.hpp"

#include <frontlux/planner/path_planner.hpp>

#include <algorithm>
#include <set>

namespace frontlux::planner {

using Keys = std::vector<VoxelKey>;

// Whether a robot has no goal and stays where it is, unless it is asked to make room.
bool ContinuousExploration::State::rests_without_goal(const Member& member) const {
  return member.planned && !member.is_lost() && !member.is_going() && !member.goal.pose;
}

bool ContinuousExploration::State::waits_for_room(std::size_t robot) const {
  return std::ranges::any_of(
      members, [&](const Member& member) { return member.request && member.request->by == robot; });
}

void ContinuousExploration::State::withdraw_requests(std::size_t robot) {
  members[robot].others_rested.clear();
  members[robot].asks = true;
  for (Member& member : members)
    if (member.request && member.request->by == robot) member.request.reset();
}

// Who rests where it did before opens nothing that was closed: the others do not begin to wait anew.
void ContinuousExploration::State::tell_of_rest(std::size_t robot) {
  if (!team.tours) return;
  const auto place = team.lattice().key(members[robot].motion.last().end_pose().position);
  const bool is_new = std::exchange(members[robot].told_from, place) != place;
  for (std::size_t other = 0; other < members.size(); ++other) {
    Member& member = members[other];
    if (other == robot || member.is_lost() || member.is_going()) continue;
    member.others_rest = member.asks = true;
    if (is_new) member.waits = 0;
  }
}

void ContinuousExploration::State::tell_of_loss(std::size_t robot) {
  for (std::size_t other = 0; other < members.size(); ++other) {
    Member& member = members[other];
    if (other == robot || member.is_lost()) continue;
    member.others_rest = member.asks = true;
    member.waits = member.low_gains = 0;
  }
}

// Those whose next trajectories have not begun yet are on the ones before until then.
void ContinuousExploration::State::tell_of_stop(std::size_t robot, double time) {
  const Trajectory& stop = members[robot].motion.last();
  for (std::size_t other = 0; other < members.size(); ++other) {
    Member& member = members[other];
    if (other != robot && !member.is_lost() && member.motion.last().end() > time)
      member.meets_other = member.meets_other || !keeps_apart(robot, stop, time, other);
  }
}

// It has made room, or cannot.
void ContinuousExploration::State::end_request(std::size_t robot) {
  std::optional<Request>& request = members[robot].request;
  if (request) team.tours->look_again(request->by);
  request.reset();
}

// The path of a robot to something to see, if the others that rest were not there; empty if there is none.
Keys ContinuousExploration::State::path_without_resting(std::size_t robot, ExplorationStep& step) {
  const detail::CountingRayCaster counting(*team.caster, team.lattice());
  const TravelCorridor& corridor = team.selection->corridor(robot);
  const auto keep_out_of = [&](Others which, CorridorExtent extent) {
    team.selection->keep_out_of(robot, places_of_others(robot, which));
    team.update_corridor(robot, step, extent);
  };
  const CorridorExtent extent = corridor.extent();
  keep_out_of(Others::kThatDoNotRest, CorridorExtent::kAllCells);
  Keys path;
  {
    const detail::PhaseClock clock(step, Phase::kGoals);
    const auto to = team.tours->place_to_see_from(
        robot, counting, team.mapping.grid(), [&](const VoxelKey& cell) { return corridor.contains(cell); });
    if (to) path = corridor.path_to(*to);
  }
  step.rays += counting.rays();
  keep_out_of(Others::kAll, extent);
  return path;
}

// Of a robot on tours that has no goal: if others that rest keep it from what it would see, they are asked to
// leave its path to there. It is asked for when another one has come to rest, and no more than twice with all
// in the same places, or they would go to and fro.
void ContinuousExploration::State::ask_for_room(std::size_t robot, ExplorationStep& step) {
  constexpr int kTimes = 2;
  Member& member = members[robot];
  if (!team.tours || waits_for_room(robot) || !member.asks) return;
  member.asks = false;
  std::vector<std::size_t> resting;
  Keys places;
  for (std::size_t other = 0; other < members.size(); ++other) {
    const auto place = team.lattice().key(team.poses[other].position);
    if (other == robot || !place || !(rests_without_goal(members[other]) || members[other].is_lost()))
      continue;
    places.push_back(*place);
    if (!members[other].is_lost()) resting.push_back(other);
  }
  if (resting.empty() || std::ranges::count(member.others_rested, places) >= kTimes) return;
  member.others_rested.push_back(std::move(places));
  const Keys path = path_without_resting(robot, step);
  for (const std::size_t other : resting) {
    const auto place = cells_too_near(robot, other, team.poses[other].position, 0.0);
    const auto in_place = [&](const VoxelKey& cell) { return place && place->contains(cell); };
    if (std::ranges::any_of(path, in_place)) members[other].request = Request{robot, path};
  }
}

// To a place near by, beside the path of the robot that has asked; empty if there is none, or it is there.
std::vector<Pose> ContinuousExploration::State::path_aside(std::size_t robot) const {
  constexpr std::size_t kMost = 100'000;  // cells
  const Member& member = members[robot];
  const auto here = team.lattice().key(team.poses[robot].position);
  if (!member.request || !here) return {};
  const TravelCorridor& corridor = team.path_corridor(robot);
  const auto is_beside = [&](const VoxelKey& cell) {
    const auto near = cells_too_near(member.request->by, robot, team.lattice().exact_center(cell), 0.0);
    return !near || std::ranges::none_of(member.request->path,
                                         [&](const VoxelKey& key) { return near->contains(key); });
  };
  std::set<VoxelKey> known{*here};
  Keys cells{*here};
  for (std::size_t i = 0; i < cells.size() && cells.size() < kMost; ++i) {
    const VoxelKey cell = cells[i];
    if (is_beside(cell)) {
      if (cell == *here) return {};
      Pose place = team.poses[robot];
      place.position = corridor.place_in(cell);
      return plan_path(corridor, team.lattice(), team.poses[robot], place,
                       {team.options.seed, team.number, robot}, team.options.path)
          .viewpoints;
    }
    for_each_key(grown({cell, cell}, 1), [&](const VoxelKey& next) {
      if (corridor.contains(next) && known.insert(next).second) cells.push_back(next);
    });
  }
  return {};
}

}  // namespace frontlux::planner
