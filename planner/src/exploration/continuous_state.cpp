#include "exploration/continuous_state.hpp"

#include "exploration/phase_clock.hpp"
#include "exploration/trail.hpp"
#include "mapping/sort_once.hpp"

#include <algorithm>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::sort_once;

using Keys = std::vector<VoxelKey>;

constexpr double kMostUnknown = 0.2;  // of a goal's frontiers, when it has been seen
constexpr int kMostWaits = 10;    // plannings in a row, one in a period, for which a robot waits for others
constexpr double kSoonest = 0.4;  // of the period, before a robot with such a goal plans again
// Periods for which a robot rests until it has nothing to do: scans free by then what a stray return has
// closed.
constexpr double kPatience = 1.5;
constexpr double kLongPatience = 10.0;  // without a scan from where it rests

}  // namespace

void ContinuousExploration::State::set_motion(std::size_t robot, Trajectory trajectory) {
  members[robot].motion = {std::move(trajectory)};
  members[robot].samples = 0;
}

// The trajectories whose time has come take the place of those before.
void ContinuousExploration::State::start_next_trajectories(double time) {
  for (std::size_t r = 0; r < members.size(); ++r) {
    std::optional<Trajectory>& next = members[r].motion.next;
    if (!next || time < next->begin()) continue;
    extend_trail(r, next->begin());
    set_motion(r, Trajectory(*next));
  }
}

std::optional<PlanReason> ContinuousExploration::State::reason_to_plan(const Member& member,
                                                                       double time) const {
  if (member.is_lost()) return std::nullopt;
  if (!member.planned) return PlanReason::kStart;
  if (member.motion.next) return std::nullopt;  // its next trajectory has not begun yet
  const double age = time - *member.planned;
  if (age <= 0.0) return std::nullopt;
  if (member.stopped) return PlanReason::kStopped;
  if (age < team.options.latency) return std::nullopt;
  if (member.meets_other) return PlanReason::kBlocked;
  // What did not work where it rests is not tried again at once.
  const bool has_tried =
      member.activity == Activity::kTriesAgain && member.motion.last().end() <= *member.planned;
  const bool arrives = time + team.options.latency >= member.motion.last().end() &&
                       (!has_tried || age >= team.options.period * kSoonest);
  if (member.blocked) return PlanReason::kBlocked;
  const bool leaves = member.activity == Activity::kRetreats || member.activity == Activity::kMakesRoom;
  if (leaves && !arrives) return std::nullopt;
  if (member.is_going() && (member.goal_frontiers.empty() ? arrives : has_looked(member, time)))
    return PlanReason::kArrival;
  if (member.is_going() && !member.goal_frontiers.empty() && age >= team.options.period * kSoonest) {
    const auto unknown = std::ranges::count_if(member.goal_frontiers, [&](const VoxelKey& key) {
      return team.mapping.grid().at(key) == Occupancy::kUnknown;
    });
    if (static_cast<double>(unknown) <= kMostUnknown * static_cast<double>(member.goal_frontiers.size()))
      return PlanReason::kGoalSeen;
  }
  const auto is_going = [](const Member& other) { return other.is_going(); };
  const bool would_end = member.others_rest && std::ranges::none_of(members, is_going);
  if (age >= team.options.period || would_end) return PlanReason::kPeriod;
  return std::nullopt;
}

// A robot on a plane stays on it, whatever its localization says: a millimetre may be another layer of the
// map.
void ContinuousExploration::State::stay_on_plane(std::size_t robot, Pose& pose, double time) const {
  if (team.options.team[robot].robot.travel.motion == Motion::kPlane)
    pose.position.z() = members[robot].motion.at(time).pose.position.z();
}

// Takes note of what a scan has changed.
void ContinuousExploration::State::note_scan(std::size_t robot, const MapChange& change) {
  for (const VoxelKey& key : change.keys) {
    touched.emplace_back(key, robot);
    const bool is_free = change.grid.at(key) == Occupancy::kFree;
    for (Member& member : members) is_free ? member.note_opened(key) : member.note_closed(key);
  }
}

// Voxels that are closed from now on though the map has them free. A robot that goes back as it came does so
// where the map lets it.
void ContinuousExploration::State::note_solid(std::span<const VoxelKey> voxels) {
  for (Member& member : members)
    if (member.activity != Activity::kRetreats)
      std::ranges::for_each(voxels, [&](const VoxelKey& key) { member.note_closed(key); });
}

// In which only their bodies can be, of robots on tours.
Keys ContinuousExploration::State::voxels_of_robots(double time) const {
  Keys keys;
  if (!team.tours) return keys;
  for (std::size_t r = 0; r < members.size(); ++r) {
    const auto own = team.lattice().key(members[r].motion.at(time).pose.position);
    if (own && !members[r].is_lost() && team.fills_its_voxel(r)) keys.push_back(*own);
  }
  return keys;
}

// What the robots have done since the last planning. A voxel that several have changed counts for the first.
ExplorationStep ContinuousExploration::State::collect(double time) {
  ExplorationStep step = team.new_step();
  step.time = time;
  std::optional<detail::PhaseClock> clock(std::in_place, step, Phase::kFrontiers);
  const VoxelGrid& grid = team.mapping.grid();
  Keys changed;
  std::ranges::stable_sort(touched, {}, &std::pair<VoxelKey, std::size_t>::first);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    const auto& [key, robot] = touched[i];
    if (i > 0 && touched[i - 1].first == key) continue;
    const Occupancy was = before.at(key), is = grid.at(key);
    if (was == is) continue;
    step.robots[robot].changed.push_back({key, was, is});
    before.set(key, is);
    changed.push_back(key);
  }
  touched.clear();
  const Keys further = team.conservative_map->update(grid, changed, voxels_of_robots(time));
  team.also_changed.insert(team.also_changed.end(), further.begin(), further.end());
  for (std::size_t r = 0; r < members.size(); ++r) {
    RobotStep& robot = step.robots[r];
    robot.goal = members[r].goal;
    robot.path = PathOutcome::kInPlace;
    robot.blocked = std::exchange(members[r].held_back_from, {});
    sort_once(robot.blocked);
    robot.planned = std::move(members[r].sensed);
    robot.travelled = robot.planned.size();
    robot.length = path_length(robot.planned);
    robot.gained = team.mapped_frontiers(robot.changed);
    members[r].gained += robot.gained;
    members[r].sensed = {robot.planned.back()};
    extend_trail(r, time);
  }
  clock.reset();
  return step;
}

// The cells in whose middle a robot would be too near to another one that is at a place, or more of them.
// @param shrunk  [cells] how far inside of these a cell has to lie
std::optional<KeyBox> ContinuousExploration::State::cells_too_near(std::size_t robot, std::size_t other,
                                                                   const Eigen::Vector3d& other_at,
                                                                   double shrunk) const {
  const TravelOptions& travel = team.options.team[robot].robot.travel;
  const auto box = detail::positions_too_near(body_of(travel), body_of(team.options.team[other].robot.travel),
                                              other_at, kSeparation);
  const bool on_plane = travel.motion == Motion::kPlane;
  const double height = team.poses[robot].position.z();
  if (on_plane && (height <= box.min().z() || height >= box.max().z())) return std::nullopt;
  const Eigen::Vector3d inside = Eigen::Vector3d::Constant(shrunk * team.lattice().resolution());
  Eigen::Vector3d lowest = box.min() + inside, highest = box.max() - inside;
  if (on_plane) lowest.z() = highest.z() = height;  // its own layer, wherever in it the sensor is
  const auto key_of = [&](const Eigen::Vector3d& at, std::uint16_t outside) {
    const auto along = [&](double x) { return team.lattice().key(x).value_or(outside); };
    return VoxelKey{along(at.x()), along(at.y()), along(at.z())};
  };
  return KeyBox{key_of(lowest, 0), key_of(highest, 0xFFFF)};
}

// The cells that are too near to where others will come to rest.
std::vector<KeyBox> ContinuousExploration::State::places_of_others(std::size_t robot, Others which) const {
  std::vector<KeyBox> places;
  for (std::size_t other = 0; other < members.size(); ++other) {
    if (other == robot || (which == Others::kThatDoNotRest && rests_without_goal(members[other]))) continue;
    const Pose end = members[other].motion.last().end_pose();
    const double shrunk = members[robot].keeps_out_of_all() ? 0.0 : 0.5;
    if (auto cells = cells_too_near(robot, other, end.position, shrunk)) places.push_back(*cells);
  }
  return places;
}

PlannedMotion ContinuousExploration::State::plan(std::size_t robot, PlanReason reason, double time) {
  Member& member = members[robot];
  const double start = time + team.options.latency;
  ExplorationStep step = collect(time);
  std::vector<MotionState> starts;
  for (std::size_t r = 0; r < members.size(); ++r) {
    starts.push_back(members[r].motion.at(start));
    team.poses[r] = starts[r].pose;
  }
  team.update_frontiers(step);
  const std::vector<KeyBox> others = places_of_others(robot, Others::kAll);
  team.selection->keep_out_of(robot, others);
  if (team.voxel_corridors[robot]) team.voxel_corridors[robot]->keep_out_of(others);
  team.update_views(step);
  note_look(robot, reason, step);
  // Along a tour a robot that has learnt next to nothing has no reason to change its mind: it would turn back
  // and forth between stops that are about as good.
  const bool as_before = !team.tours || static_cast<double>(member.gained) < team.tours->least_gain(robot);
  bool keeps = as_before && reason == PlanReason::kPeriod && member.is_going() && member.goal.pose &&
               !member.goal_frontiers.empty() && time - member.chosen < team.options.commitment;
  member.gained = 0;
  if (keeps && team.tours)
    keeps = team.keep_stop(robot, step);
  else if (keeps)
    team.update_corridor(robot, step);
  if (!keeps && team.tours)
    team.plan_tours(robot, starts, step);
  else if (!keeps)
    team.select_goals(step, robot);
  if (team.tours) team.note_assignment(step);
  team.count_frontiers(step);
  if (!keeps) {
    member.chosen = time;
    member.missed_looks = 0;
  }

  const bool rested = rests_without_goal(member);
  member.others_rest = false;
  if (member.blocked && step.robots[robot].goal.state == GoalState::kNoCorridor)
    team.abandoned.turned_back(member.goal_frontiers);
  Trajectory trajectory = find_trajectory(robot, start, step);
  member.goal = step.robots[robot].goal;
  take_up(robot, start, trajectory, step);
  member.planned = time;
  if (rests_without_goal(member) && !rested) tell_of_rest(robot);
  member.blocked = member.meets_other = member.stopped = false;
  count_low_gain(robot, step.robots[robot], keeps);
  ++team.number;
  step.robots[robot].trajectory = detail::poses_along(trajectory, start);
  PlannedMotion planned{robot, reason, std::move(trajectory), std::move(step)};
  // While it keeps its goal another robot's planning may have arranged the rest of its tour anew.
  if (team.tours && !keeps)
    for (const detail::TourStop& stop : team.tours->tour(robot))
      planned.step.robots[robot].tour.push_back({stop.pose, stop.clusters.size(), stop.seen});
  return planned;
}

// And plannings in which it waits: `end` decides by both. A goal that is kept counts once: it is not reached.
// What shows too little is no stop of a tour.
void ContinuousExploration::State::count_low_gain(std::size_t robot, const RobotStep& step, bool kept) {
  Member& member = members[robot];
  const bool waits = !member.is_going() && (step.goal.pose || member.request || waits_for_room(robot));
  const bool low =
      !team.tours && (step.goal.pose ? step.goal.gain < team.options.epsilon : !member.is_going() && !waits);
  if (!kept) member.low_gains = low ? member.low_gains + 1 : 0;
  if (member.is_going())
    member.idle_since.reset();
  else if (!member.idle_since)
    member.idle_since = member.planned;
  // That there is no goal outside of all cells in which others might be is no answer yet.
  const bool kept_out = member.keeps_out_of_all() && !member.is_going();
  member.waits = waits || kept_out ? member.waits + 1 : 0;
  if (member.waits > kMostWaits && member.request) end_request(robot);
}

// A scan from where it rests may be on its way still, and show something to do.
bool ContinuousExploration::State::has_nothing_to_do(const Member& member) const {
  if (member.is_lost()) return true;
  if (member.is_going() || member.others_rest) return false;
  const bool looked_from_end = member.last_look && is_at_end(member, *member.last_look);
  const double patience = (looked_from_end ? kPatience : kLongPatience) * team.options.period;
  return member.waits > kMostWaits ||
         (member.waits == 0 && member.idle_since && *member.planned - *member.idle_since >= patience);
}

}  // namespace frontlux::planner
