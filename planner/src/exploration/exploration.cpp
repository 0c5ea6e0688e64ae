#include "exploration/exploration_state.hpp"
#include "exploration/path_execution.hpp"
#include "exploration/phase_clock.hpp"
#include "goal/counting_ray_caster.hpp"

#include <frontlux/planner/look_around.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("exploration: " + what); }

std::optional<KeyBox> box_around(std::span<const VoxelKey> keys) {
  if (keys.empty()) return std::nullopt;
  KeyBox box{keys.front(), keys.front()};
  for (const VoxelKey& key : keys) {
    box.min = {std::min(box.min.x, key.x), std::min(box.min.y, key.y), std::min(box.min.z, key.z)};
    box.max = {std::max(box.max.x, key.x), std::max(box.max.y, key.y), std::max(box.max.z, key.z)};
  }
  return box;
}

}  // namespace

Exploration::State::State(ExplorationOptions given, Mapping map)
    : options(std::move(given)),
      mapping(std::move(map)),
      frontiers(mapping.grid(), mapping.bounds()),
      caster(make_ray_caster(options.caster, mapping.grid(), mapping.tree())),
      abandoned(options.max_visits) {}

void Exploration::State::select_from(std::span<const ExplorationStart> starts) {
  std::vector<TeamMember> team = options.team;
  for (std::size_t r = 0; r < size(); ++r) {
    TravelOptions& travel = team[r].robot.travel;
    // No sensor sees the floor on which its robot stands.
    if (const auto box = box_around(starts[r].known_free); box && travel.motion == Motion::kPlane)
      travel.without_ground.push_back(*box);
    ways.emplace_back();
    if (travel.node_edge == 0.0) continue;
    TravelOptions by_voxels = travel;
    by_voxels.node_edge = 0.0;
    ways.back().emplace(by_voxels, lattice(), mapping.bounds());
  }
  selection.emplace(std::move(team), lattice(), mapping.bounds(), options.distribute);
}

Exploration::Exploration(ExplorationOptions options, Mapping mapping) {
  options.check();
  state_ = std::make_unique<State>(std::move(options), std::move(mapping));
}
Exploration::~Exploration() = default;
Exploration::Exploration(Exploration&&) noexcept = default;
Exploration& Exploration::operator=(Exploration&&) noexcept = default;

ExplorationStep Exploration::begin(std::span<const ExplorationStart> starts, const Drive& drive) {
  State& state = *state_;
  if (state.selection) refuse("it has begun already");
  if (starts.size() != state.size())
    refuse(std::to_string(starts.size()) + " starts for " + std::to_string(state.size()) + " robots");
  std::vector<Pose> poses;
  for (const ExplorationStart& start : starts) poses.push_back(start.pose);
  check_finite(poses);
  state.poses = std::move(poses);
  state.trails.resize(starts.size());
  state.select_from(starts);

  ExplorationStep step;
  step.robots.resize(starts.size());
  {
    const detail::PhaseClock clock(step, Phase::kMoving);
    for (std::size_t r = 0; r < starts.size(); ++r) {
      RobotStep& robot = step.robots[r];
      const VoxelGrid before = state.mapping.grid();
      State::Keys touched = state.mapping.mark_free(starts[r].known_free);
      // The first look is the way's first viewpoint, at which `travel` does not measure.
      robot.path = PathOutcome::kInPlace;
      robot.planned = {starts[r].pose};
      for (Pose look : look_around(state.options.team[r].robot.view, starts[r].pose)) {
        look.yaw = std::remainder(look.yaw, 2 * std::numbers::pi);
        robot.planned.push_back(look);
      }
      if (robot.planned.size() > 2) robot.planned.push_back(starts[r].pose);  // it goes on from how it stood
      const detail::PathExecution journey = detail::travel(r, robot.planned, nullptr, drive, state.mapping);
      robot.travelled = journey.travelled;
      for (const VoxelChange& change : journey.changed) touched.push_back(change.key);
      robot.changed = detail::differences(before, state.mapping.grid(), std::move(touched));
      state.take(robot, r);
    }
  }
  const detail::PhaseClock clock(step, Phase::kFrontiers);
  state.follow(step);
  state.number = 1;
  return step;
}

// Alg. 1, one round of the loop that begins at line 3.
ExplorationStep Exploration::step(const Drive& drive) {
  State& state = *state_;
  if (!state.selection) refuse("a step before its beginning");
  ExplorationStep step;
  step.number = state.number;
  step.robots.resize(state.size());
  TeamGoals goals = state.select_goals(step);  // Alg. 1, lines 4 and 5
  std::vector<State::Plan> plans(state.size());
  const detail::CountingRayCaster counting(*state.caster, state.lattice());
  for (std::size_t r = 0; r < state.size(); ++r) {
    RobotStep& robot = step.robots[r];
    robot.goal = std::move(goals.goals[r]);
    if (state.options.team[r].robot.travel.motion == Motion::kPlane)
      robot.image = state.selection->rendered_cells(r);
    {
      const detail::PhaseClock clock(step, Phase::kPaths);
      state.plan_way(r, robot);  // Alg. 1, line 6
    }
    const detail::PhaseClock clock(step, Phase::kOptimization);
    plans[r] = state.optimize(r, counting, robot);  // Alg. 1, line 7
  }
  step.rays += counting.rays();
  {
    const detail::PhaseClock clock(step, Phase::kMoving);
    for (std::size_t r = 0; r < state.size(); ++r) {
      state.go(r, plans[r], drive, step.robots[r]);  // Alg. 1, lines 8 to 11
      state.take(step.robots[r], r);
    }
  }
  {
    const detail::PhaseClock clock(step, Phase::kFrontiers);
    state.follow(step);
  }
  state.close(step);
  return step;
}

bool Exploration::repeat(const ExplorationStep& recorded, const Drive& drive) {
  State& state = *state_;
  if (!state.selection) refuse("a step before its beginning");
  if (recorded.number != state.number || recorded.robots.size() != state.size()) return false;
  // For what the selection keeps from step to step: how many rays the next one casts depends on it.
  ExplorationStep again;
  static_cast<void>(state.select_goals(again));
  for (std::size_t r = 0; r < state.size(); ++r) {
    const RobotStep& robot = recorded.robots[r];
    if (robot.travelled > robot.planned.size()) return false;
    std::vector<Pose> way(robot.planned.begin(),
                          robot.planned.begin() + static_cast<std::ptrdiff_t>(robot.travelled));
    const detail::PathExecution journey = detail::travel(r, way, nullptr, drive, state.mapping);
    if (journey.travelled != robot.travelled || journey.changed != robot.changed) return false;
    state.take(robot, r);
  }
  state.follow(recorded);
  state.close(recorded);
  return true;
}

// Line 3: what the end depends on.
void Exploration::State::close(const ExplorationStep& step) {
  double promised = 0.0;
  bool on_way_back = false;
  idle = true;
  for (const RobotStep& robot : step.robots) {
    const bool went = robot.travelled > 1;
    if (robot.goal.pose || went) idle = false;
    if (went && robot.goal.pose) promised += static_cast<double>(robot.gain_predicted);
    on_way_back = on_way_back || (went && !robot.goal.pose);
  }
  if (promised >= options.epsilon)
    quiet = 0;
  else if (!on_way_back)
    ++quiet;
  number = step.number + 1;
}

std::optional<ExplorationEnd> Exploration::end() const {
  const State& state = *state_;
  if (state.idle) return ExplorationEnd::kNothingToDo;
  if (state.quiet >= state.options.quiet_steps) return ExplorationEnd::kQuiet;
  if (state.number > static_cast<std::uint64_t>(state.options.max_steps)) return ExplorationEnd::kStepLimit;
  return std::nullopt;
}

const ExplorationOptions& Exploration::options() const { return state_->options; }
const Mapping& Exploration::mapping() const { return state_->mapping; }
std::span<const Pose> Exploration::poses() const { return state_->poses; }
std::span<const VoxelKey> Exploration::frontiers() const { return state_->frontiers.keys(); }

}  // namespace frontlux::planner
