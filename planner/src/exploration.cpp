#include "counting_ray_caster.hpp"
#include "journey.hpp"
#include "small_clusters.hpp"
#include "stubborn_frontiers.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/frontier.hpp>
#include <frontlux/planner/look_around.hpp>
#include <frontlux/planner/visible_pairs.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

using Keys = std::vector<VoxelKey>;

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("exploration: " + what); }

std::unique_ptr<RayCaster> make_caster(CasterKind kind, const Mapping& mapping) {
  switch (kind) {
    case CasterKind::kGrid:
      return make_grid_ray_caster(mapping.grid());
    case CasterKind::kOctomap:
      return make_octomap_ray_caster(mapping.tree());
    case CasterKind::kEmbree:
      break;
  }
  return make_embree_ray_caster(mapping.grid());
}

// Adds the time that it lives to a phase.
class PhaseClock {
 public:
  PhaseClock(ExplorationStep& step, Phase phase) : seconds_(step.seconds[static_cast<std::size_t>(phase)]) {}
  ~PhaseClock() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  PhaseClock(const PhaseClock&) = delete;
  PhaseClock& operator=(const PhaseClock&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

std::optional<KeyBox> box_around(std::span<const VoxelKey> keys) {
  if (keys.empty()) return std::nullopt;
  KeyBox box{keys.front(), keys.front()};
  for (const VoxelKey& key : keys) {
    box.min = {std::min(box.min.x, key.x), std::min(box.min.y, key.y), std::min(box.min.z, key.z)};
    box.max = {std::max(box.max.x, key.x), std::max(box.max.y, key.y), std::max(box.max.z, key.z)};
  }
  return box;
}

// Targets in view from where the robot has been, first place left out, that are unknown still.
Keys still_unknown(const VoxelGrid& grid, const InformationGain& gain, std::span<const Pose> viewpoints,
                   std::span<const VoxelKey> targets) {
  Keys keys;
  std::vector<std::uint8_t> in_view;
  for (std::size_t i = 1; i < viewpoints.size(); ++i) {
    const auto seen = gain.frontiers_of(i);
    in_view.resize(seen.size());
    gain.in_view(i, viewpoints[i].yaw, in_view);
    for (std::size_t k = 0; k < seen.size(); ++k)
      if (in_view[k] != 0 && grid.at(targets[seen[k]]) == Occupancy::kUnknown)
        keys.push_back(targets[seen[k]]);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

}  // namespace

struct Exploration::State {
  // A path and who sees what along it, until the robot has gone it.
  struct Plan {
    Keys targets;
    std::optional<InformationGain> gain;
  };

  ExplorationOptions options;
  Mapping mapping;
  FrontierSet frontiers;
  std::unique_ptr<RayCaster> caster;
  detail::StubbornFrontiers stubborn;
  std::optional<GoalSelection> selection = {};
  // Of robots whose corridor is one of nodes: they travel between the nodes by voxels.
  std::vector<std::optional<TravelCorridor>> ways = {};
  std::vector<Pose> poses = {};
  std::vector<std::vector<Pose>> trails = {};  // where each robot has been
  Keys unread = {};                            // changed since the corridors were last brought up to date
  std::uint64_t number = 0;
  int quiet = 0;
  bool idle = false;

  State(ExplorationOptions given, Mapping map)
      : options(std::move(given)),
        mapping(std::move(map)),
        frontiers(mapping.grid(), mapping.bounds()),
        caster(make_caster(options.caster, mapping)),
        stubborn(options.max_visits) {}

  [[nodiscard]] const Lattice& lattice() const { return mapping.grid().lattice(); }
  [[nodiscard]] std::size_t size() const { return options.team.size(); }

  void select_from(std::span<const ExplorationStart> starts);
  TeamGoals select_goals(ExplorationStep& step);
  [[nodiscard]] const TravelCorridor& way_of(std::size_t robot) const {
    return ways[robot] ? *ways[robot] : selection->corridor(robot);
  }
  [[nodiscard]] std::optional<VoxelKey> cell_at(const Eigen::Vector3d& position) const {
    const auto x = lattice().key(position.x()), y = lattice().key(position.y()),
               z = lattice().key(position.z());
    if (!x || !y || !z) return std::nullopt;
    return VoxelKey{*x, *y, *z};
  }
  [[nodiscard]] std::vector<Pose> way_back(std::size_t robot) const;
  void plan_way(std::size_t robot, RobotStep& planned);
  Plan optimize(std::size_t robot, const RayCaster& counting, RobotStep& planned);
  void go(std::size_t robot, const Plan& plan, const Drive& drive, RobotStep& step);
  void take(const RobotStep& step, std::size_t robot);
  void follow(const ExplorationStep& step);
  void close(const ExplorationStep& step);
};

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

// Lines 4 and 5.
TeamGoals Exploration::State::select_goals(ExplorationStep& step) {
  const VoxelGrid& grid = mapping.grid();
  Keys wanted, large;
  {
    const PhaseClock clock(step, Phase::kFrontiers);
    for (std::optional<TravelCorridor>& way : ways) {
      const auto robot = static_cast<std::size_t>(&way - ways.data());
      const auto cell = cell_at(poses[robot].position);
      if (way && cell) way->update(grid, unread, *cell);
    }
    unread.clear();
    wanted = stubborn.without_given_up(frontiers.keys());
    large = detail::in_large_clusters(frontiers, wanted, options.min_cluster_size);
    step.frontiers = frontiers.size();
    step.dropped = frontiers.size() - wanted.size();
  }
  {
    const PhaseClock clock(step, Phase::kCaster);
    caster->update(grid);
  }
  const PhaseClock clock(step, Phase::kGoals);
  const auto has_goal = [](const Goal& goal) { return goal.pose.has_value(); };
  TeamGoals goals = selection->select(*caster, grid, large, poses);
  step.rays += goals.rays;
  if (large.size() < wanted.size() && std::none_of(goals.goals.begin(), goals.goals.end(), has_goal)) {
    goals = selection->select(*caster, grid, wanted, poses);
    step.rays += goals.rays;
  }
  step.unassigned = goals.unassigned;
  return goals;
}

// A robot beside which a closer look has found something is in no corridor any more: it goes back the way it
// came, to the last place that is still in the clear.
std::vector<Pose> Exploration::State::way_back(std::size_t robot) const {
  const std::vector<Pose>& trail = trails[robot];
  for (auto place = trail.rbegin(); place != trail.rend(); ++place) {
    const auto cell = cell_at(place->position);
    if (!cell || !way_of(robot).passable(*cell)) continue;
    if (place == trail.rbegin()) return {};
    return {trail.rbegin(), place + 1};
  }
  return {};
}

// Line 6.
void Exploration::State::plan_way(std::size_t robot, RobotStep& planned) {
  if (!planned.goal.pose) {
    if (planned.goal.state == GoalState::kNoCorridor) planned.planned = way_back(robot);
    planned.path = planned.planned.empty() ? PathOutcome::kNoCorridor : PathOutcome::kFound;
    return;
  }
  PathPlan plan = plan_path(way_of(robot), lattice(), poses[robot], *planned.goal.pose,
                            {options.seed, number, robot}, options.path);
  planned.path = plan.outcome;
  planned.planned = std::move(plan.viewpoints);
}

// Line 7.
Exploration::State::Plan Exploration::State::optimize(std::size_t robot, const RayCaster& counting,
                                                      RobotStep& planned) {
  Plan plan;
  if (!planned.goal.pose || planned.planned.empty()) return plan;
  const FieldOfView& view = options.team[robot].robot.view;
  const auto targets = selection->targets(robot);
  plan.targets.assign(targets.begin(), targets.end());
  const auto centers_of_targets = centers(lattice(), plan.targets);
  const VisiblePairs pairs = visible_pairs(counting, mapping.grid(), planned.planned, plan.targets, view);
  plan.gain.emplace(planned.planned, centers_of_targets, pairs, view, options.optimizer.gain);
  PathOptimizerOptions turning = options.optimizer;
  if (!options.optimize) {
    turning.start = YawStart::kTangent;
    turning.ascend = false;
  }
  const OptimizedPath turned = optimize_path(planned.planned, centers_of_targets, pairs, view, turning);
  for (std::size_t i = 1; i + 1 < planned.planned.size(); ++i) planned.planned[i].yaw = turned.yaws[i];
  planned.gain_tangent = turned.tangent.distinct;
  planned.gain_predicted = turned.result.distinct;
  return plan;
}

// Lines 8 to 11.
void Exploration::State::go(std::size_t robot, const Plan& plan, const Drive& drive, RobotStep& step) {
  TravelOptions body = options.team[robot].robot.travel;
  body.node_edge = 0.0;
  // The way back is that on which it came.
  detail::Journey journey =
      detail::travel(robot, step.planned, step.goal.pose ? &body : nullptr, drive, mapping);
  step.travelled = journey.travelled;
  step.length = journey.length;
  step.changed = std::move(journey.changed);
  step.blocked = std::move(journey.blocked);
  step.gained = static_cast<std::uint64_t>(
      std::count_if(step.changed.begin(), step.changed.end(), [&](const VoxelChange& change) {
        return change.before == Occupancy::kUnknown && frontiers.contains(change.key);
      }));
  // A look at what is in the way is not from where the path would have led.
  const std::size_t reached = step.travelled - (step.blocked.empty() ? 0 : 1);
  if (plan.gain)
    step.stubborn = still_unknown(mapping.grid(), *plan.gain,
                                  std::span<const Pose>(step.planned).first(reached), plan.targets);
}

// What a robot's part of a step leaves behind.
void Exploration::State::take(const RobotStep& step, std::size_t robot) {
  stubborn.visited(step.stubborn);
  if (!step.blocked.empty()) {
    selection->close(robot, step.blocked);
    if (ways[robot]) ways[robot]->close(step.blocked);
  }
  for (std::size_t i = trails[robot].empty() ? 0 : 1; i < step.travelled; ++i)
    trails[robot].push_back(step.planned[i]);
  if (step.travelled > 0) poses[robot] = step.planned[step.travelled - 1];
}

// Brings the frontiers up to date with what the robots changed.
void Exploration::State::follow(const ExplorationStep& step) {
  Keys changed;
  for (const RobotStep& robot : step.robots)
    for (const VoxelChange& change : robot.changed) changed.push_back(change.key);
  frontiers.update(mapping.grid(), changed);
  unread.insert(unread.end(), changed.begin(), changed.end());
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
    const PhaseClock clock(step, Phase::kMoving);
    for (std::size_t r = 0; r < starts.size(); ++r) {
      RobotStep& robot = step.robots[r];
      const VoxelGrid before = state.mapping.grid();
      Keys touched = state.mapping.mark_free(starts[r].known_free);
      // The first look is the way's first viewpoint, at which `travel` does not measure.
      robot.path = PathOutcome::kInPlace;
      robot.planned = {starts[r].pose};
      for (Pose look : look_around(state.options.team[r].robot.view, starts[r].pose)) {
        look.yaw = std::remainder(look.yaw, 2 * std::numbers::pi);
        robot.planned.push_back(look);
      }
      if (robot.planned.size() > 2) robot.planned.push_back(starts[r].pose);  // it goes on from how it stood
      const detail::Journey journey = detail::travel(r, robot.planned, nullptr, drive, state.mapping);
      robot.travelled = journey.travelled;
      for (const VoxelChange& change : journey.changed) touched.push_back(change.key);
      robot.changed = detail::differences(before, state.mapping.grid(), std::move(touched));
      state.take(robot, r);
    }
  }
  const PhaseClock clock(step, Phase::kFrontiers);
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
      const PhaseClock clock(step, Phase::kPaths);
      state.plan_way(r, robot);  // Alg. 1, line 6
    }
    const PhaseClock clock(step, Phase::kOptimization);
    plans[r] = state.optimize(r, counting, robot);  // Alg. 1, line 7
  }
  step.rays += counting.rays();
  {
    const PhaseClock clock(step, Phase::kMoving);
    for (std::size_t r = 0; r < state.size(); ++r) {
      state.go(r, plans[r], drive, step.robots[r]);  // Alg. 1, lines 8 to 11
      state.take(step.robots[r], r);
    }
  }
  {
    const PhaseClock clock(step, Phase::kFrontiers);
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
    const detail::Journey journey = detail::travel(r, way, nullptr, drive, state.mapping);
    if (journey.travelled != robot.travelled || journey.changed != robot.changed) return false;
    state.take(robot, r);
  }
  state.follow(recorded);
  state.close(recorded);
  return true;
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
