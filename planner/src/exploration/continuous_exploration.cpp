#include "exploration/continuous_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("continuous exploration: " + what);
}

// Beyond it parts of a second get lost in a double, and time stands still.
void check_time(double time) {
  constexpr double kLatest = 1e10;  // [s]
  if (!(std::abs(time) <= kLatest))
    refuse("the time is " + std::to_string(time) + " s, but has to be finite and within 10^10 s (300 years)");
}

// How soon a robot with a reason is to plan, and of equals who has waited for longer [s].
using Turn = std::pair<int, double>;

// Who may have to brake comes first. Where plannings take long, the first robots have a reason again before
// the last ones have had their turn: who has waited for long comes before others.
Turn turn_of(PlanReason reason, double waited, double period) {
  if (waited >= 4 * period) return {3, waited};
  if (reason == PlanReason::kStopped || reason == PlanReason::kBlocked) return {2, 0.0};
  if (waited >= 2 * period) return {1, waited};
  return {0, 0.0};
}

}  // namespace

std::string_view name_of(PlanReason reason) {
  constexpr std::array<std::string_view, 6> kNames = {"start",   "arrival", "goal_seen",
                                                      "blocked", "stopped", "period"};
  return kNames.at(static_cast<std::size_t>(reason));
}

ContinuousExploration::ContinuousExploration(ExplorationOptions options, Mapping mapping) {
  options.check();
  const VoxelGrid grid = mapping.grid();
  state_ = std::make_unique<State>(State{.team = {std::move(options), std::move(mapping)}, .before = grid});
}
ContinuousExploration::~ContinuousExploration() = default;
ContinuousExploration::ContinuousExploration(ContinuousExploration&&) noexcept = default;
ContinuousExploration& ContinuousExploration::operator=(ContinuousExploration&&) noexcept = default;

ExplorationStep ContinuousExploration::begin(std::span<const ExplorationStart> starts, double time) {
  State& state = *state_;
  if (state.team.selection) refuse("it has begun already");
  if (starts.size() != state.team.size())
    refuse(std::to_string(starts.size()) + " starts for " + std::to_string(state.team.size()) + " robots");
  check_time(time);
  std::vector<Pose> poses;
  for (const ExplorationStart& start : starts) poses.push_back(start.pose);
  check_finite(poses);
  if (!std::ranges::all_of(
          poses, [&](const Pose& pose) { return state.team.lattice().key(pose.position).has_value(); }))
    refuse("a start outside the map's key range");
  state.team.start_from(starts);
  for (std::size_t r = 0; r < starts.size(); ++r) {
    State::Member member{.motion = {Trajectory(starts[r].pose, time)}};
    member.sensed.push_back(starts[r].pose);
    state.members.push_back(std::move(member));
  }
  const VoxelGrid given = state.team.mapping.grid();
  for (std::size_t r = 0; r < starts.size(); ++r)
    state.note_scan(r, state.team.mapping.mark_free(state.team.free_at_start(r, starts[r], given)));
  state.team.conservative_map.emplace(state.team.mapping.grid());
  ExplorationStep step = state.collect(time);
  state.team.update_frontiers(step);
  detail::ExplorationState::tell_of_given_map(given, step);
  state.team.number = 1;
  return step;
}

MapChange ContinuousExploration::insert(std::size_t robot, const Pose& pose, const Scan& scan) {
  State& state = *state_;
  if (robot >= state.members.size()) refuse("there is no robot " + std::to_string(robot));
  check_finite({&pose, 1});
  const MapChange change = state.team.mapping.insert(scan);
  state.note_scan(robot, change);
  const std::vector<VoxelKey> closed = state.team.conservative_map->insert(scan, state.team.mapping, change);
  if (state.team.tours) state.note_solid(closed);
  State::Member& member = state.members[robot];
  member.sensed.push_back(pose);
  std::vector<Eigen::Vector3f> measured;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    if (!std::isnan(scan.ranges[i])) measured.push_back(scan.directions[i]);
  member.sees_nothing = measured.empty();
  if (!measured.empty()) {
    member.last_look = pose;
    state.stay_on_plane(robot, *member.last_look, member.motion.now.begin());
    member.measured = std::move(measured);
    member.looked = true;
  }
  return change;
}

// A robot has left its trajectory and rests.
void ContinuousExploration::rest(std::size_t robot, const Pose& pose, double time) {
  State& state = *state_;
  if (robot >= state.members.size()) refuse("there is no robot " + std::to_string(robot));
  check_time(time);
  check_finite({&pose, 1});
  State::Member& member = state.members[robot];
  Pose resting = pose;
  state.stay_on_plane(robot, resting, time);
  if (!state.team.lattice().key(resting.position)) refuse("a pose outside the map's key range");
  state.start_next_trajectories(time);
  state.extend_trail(robot, time);
  state.cut_trail(robot, resting.position);
  state.set_motion(robot, Trajectory(resting, time));
  member.stopped = true;
  member.blocked = false;
  for (auto* const keys : {&member.needed, &member.closed, &member.floor, &member.opened}) keys->clear();
}

void ContinuousExploration::stopped(std::size_t robot, const Pose& pose, double time,
                                    std::span<const VoxelKey> blocked) {
  rest(robot, pose, time);
  State& state = *state_;
  constexpr double kBetween = 0.1;  // [s] places of a trail, at most
  state.leave_trail(robot, state.team.lattice().resolution() +
                               kBetween * state.team.options.team[robot].robot.limits.speed);
  State::Member& member = state.members[robot];
  std::vector<VoxelKey> cells(blocked.begin(), blocked.end());
  const auto is_new = [&](const VoxelKey& cell) { return state.team.path_corridor(robot).fits(cell); };
  const bool learns = !cells.empty() && (!member.planned || std::ranges::any_of(cells, is_new));
  const auto here = state.team.lattice().key(at(robot, time).pose.position);
  if (here && !learns) cells.push_back(*here);
  member.held_back_from.insert(member.held_back_from.end(), cells.begin(), cells.end());
  state.team.block(robot, cells);
  state.tell_of_stop(robot, time);
}

void ContinuousExploration::displaced(std::size_t robot, const Pose& pose, double time) {
  rest(robot, pose, time);
  state_->leave_trail(robot, 0.0);
  state_->tell_of_stop(robot, time);
}

void ContinuousExploration::lose(std::size_t robot, const Pose& pose, double time) {
  stopped(robot, pose, time, {});  // in a cell that it may not be in, none is in its reach
  State::Member& member = state_->members[robot];
  member.activity = State::Activity::kLost;
  member.meets_other = false;
  member.request.reset();
  state_->withdraw_requests(robot);
  state_->tell_of_loss(robot);
  member.goal = {};
  member.goal_frontiers.clear();
  state_->team.selection->lose(robot);
  state_->team.targets[robot].clear();
  if (state_->team.tours) state_->team.tours->lose(robot);
}

void ContinuousExploration::join(std::size_t robot, const ExplorationStart& start, double time) {
  State& state = *state_;
  if (robot < state.members.size() && !state.members[robot].is_lost())
    refuse("robot " + std::to_string(robot) + " takes part already");
  displaced(robot, start.pose, time);
  State::Member& member = state.members[robot];
  State::Member joined{.motion = std::move(member.motion)};
  joined.held_back_from = std::move(member.held_back_from);
  joined.sensed = std::move(member.sensed);
  member = std::move(joined);
  const ExplorationStart rests{at(robot, time).pose, start.known_free};  // of a robot on a plane not at any z
  state.team.join(robot, rests);
  const std::vector<VoxelKey> free = state.team.free_at_start(robot, rests, state.team.mapping.grid());
  state.note_scan(robot, state.team.mapping.mark_free(free));
  state.team.conservative_map->forget(free);
}

std::optional<PlannedMotion> ContinuousExploration::plan(double time) {
  State& state = *state_;
  if (!state.team.selection) refuse("a planning before its beginning");
  check_time(time);
  state.start_next_trajectories(time);
  state.look_for_blocked(time);
  std::optional<std::pair<std::size_t, PlanReason>> next;
  Turn best;
  for (std::size_t r = 0; r < state.members.size(); ++r) {
    const State::Member& member = state.members[r];
    const auto reason = state.reason_to_plan(member, time);
    if (!reason) continue;
    const double waited = time - member.planned.value_or(member.motion.now.begin());
    const Turn turn = turn_of(*reason, waited, state.team.options.period);
    if (next && turn <= best) continue;
    next = {r, *reason};
    best = turn;
  }
  if (!next) return std::nullopt;
  return state.plan(next->first, next->second, time);
}

ExplorationStep ContinuousExploration::finish(double time) {
  State& state = *state_;
  if (!state.team.selection) refuse("a finish before its beginning");
  check_time(time);
  state.start_next_trajectories(time);
  ExplorationStep step = state.collect(time);
  state.team.update_frontiers(step);
  state.team.count_frontiers(step);
  // A planning that comes all the same brings corridors up to date.
  state.team.also_changed = state.team.changed;
  ++state.team.number;
  return step;
}

MotionState ContinuousExploration::at(std::size_t robot, double time) const {
  if (robot >= state_->members.size()) refuse("there is no robot " + std::to_string(robot));
  return state_->members[robot].motion.at(time);
}

std::optional<ExplorationEnd> ContinuousExploration::end() const {
  const State& state = *state_;
  if (state.members.empty()) return std::nullopt;
  const auto low = [&](const auto& member) {
    return member.is_lost() || (member.low_gains >= state.team.options.low_gain_steps && !member.others_rest);
  };
  const bool nothing_to_do = std::ranges::all_of(
      state.members, [&](const State::Member& member) { return state.has_nothing_to_do(member); });
  if (nothing_to_do || std::ranges::all_of(state.members, low)) {
    for (std::size_t r = 0; r < state.members.size(); ++r)
      if (!state.members[r].is_lost() && state.team.is_cut_off(r, state.members[r].goal))
        return ExplorationEnd::kCutOff;
    return nothing_to_do ? ExplorationEnd::kNothingToDo : ExplorationEnd::kLowGain;
  }
  if (state.team.number > static_cast<std::uint64_t>(state.team.options.max_steps))
    return ExplorationEnd::kStepLimit;
  return std::nullopt;
}

const ExplorationOptions& ContinuousExploration::options() const { return state_->team.options; }
const Mapping& ContinuousExploration::mapping() const { return state_->team.mapping; }

}  // namespace frontlux::planner
