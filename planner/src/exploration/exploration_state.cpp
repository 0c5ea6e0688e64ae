#include "exploration/exploration_state.hpp"

#include "casting/counting_ray_caster.hpp"
#include "exploration/best_candidates.hpp"
#include "exploration/execute_path.hpp"
#include "exploration/frontiers_in_view.hpp"
#include "exploration/frontiers_near_path.hpp"
#include "exploration/phase_clock.hpp"
#include "frontier/small_clusters.hpp"
#include "mapping/sort_once.hpp"
#include "motion/yaw.hpp"

#include <frontlux/planner/look_around.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/trajectory.hpp>
#include <frontlux/planner/visible_pairs.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// Targets that are in view from where the robot has been, the first viewpoint left out, and still unknown.
std::vector<VoxelKey> find_still_unknown(const VoxelGrid& grid, const InformationGain& gain,
                                         std::span<const Pose> viewpoints,
                                         std::span<const VoxelKey> targets) {
  std::vector<VoxelKey> keys;
  for (std::size_t i = 1; i < viewpoints.size(); ++i)
    for (const std::uint32_t frontier : frontiers_in_view(gain, i, viewpoints[i].yaw))
      if (grid.at(targets[frontier]) == Occupancy::kUnknown) keys.push_back(targets[frontier]);
  sort_once(keys);
  return keys;
}

}  // namespace

ExplorationState::ExplorationState(ExplorationOptions given, Mapping map)
    : options(std::move(given)),
      mapping(std::move(map)),
      frontiers(mapping.grid(), mapping.bounds()),
      caster(make_ray_caster(options.caster, mapping.grid(), mapping.tree())),
      abandoned(options.max_visits) {}

TravelOptions ExplorationState::travel_by_voxels(std::size_t robot) const {
  // With the start, where it needs to see no floor: `options` lacks that.
  TravelOptions travel = selection->team()[robot].robot.travel;
  travel.node_edge = 0.0;
  return travel;
}

ExplorationStep ExplorationState::new_step() const {
  ExplorationStep step;
  step.number = number;
  step.robots.resize(size());
  return step;
}

// No sensor sees the floor on which its robot stands.
TravelOptions ExplorationState::travel_from(const ExplorationStart& start, TravelOptions travel) const {
  if (options.tours) travel.node_edge = 0.0;  // paths of tours lead wherever the body fits
  if (!travel.drives() || start.known_free.empty()) return travel;
  KeyBox known = bounds_of(start.known_free);
  if (const auto at = lattice().key(start.pose.position)) known.min.z = known.max.z = at->z;
  travel.without_ground.push_back(known);
  return travel;
}

std::optional<TravelCorridor> ExplorationState::voxel_corridor(TravelOptions travel) const {
  if (travel.node_edge == 0.0) return std::nullopt;
  travel.node_edge = 0.0;
  return TravelCorridor(travel, lattice(), mapping.bounds());
}

// If it throws, it may be called again.
void ExplorationState::start_from(std::span<const ExplorationStart> starts) {
  std::vector<TeamMember> team = options.team;
  voxel_corridors.clear();
  poses.clear();
  for (std::size_t r = 0; r < size(); ++r) {
    TravelOptions& travel = team[r].robot.travel;
    travel = travel_from(starts[r], std::move(travel));
    voxel_corridors.push_back(voxel_corridor(travel));
  }
  for (const ExplorationStart& start : starts) poses.push_back(start.pose);
  std::vector<Robot> robots;
  for (const TeamMember& member : team) robots.push_back(member.robot);
  GoalSelection checked(std::move(team), lattice(), mapping.bounds(), options.assign);
  if (options.tours)
    tours.emplace(std::move(robots), poses, lattice(), mapping.bounds(),
                  TourPlanning::Options{.least_gain = options.epsilon, .without = options.tours_without});
  selection.emplace(std::move(checked));
  targets.resize(size());
  assigned.resize(size());
  trails.resize(size());
  ahead.resize(size());
  retreated_to.resize(size());
}

void ExplorationState::join(std::size_t robot, const ExplorationStart& start) {
  const TravelOptions travel = travel_from(start, selection->team()[robot].robot.travel);
  selection->join(robot, travel);
  voxel_corridors[robot] = voxel_corridor(travel);
  if (tours) tours->join(robot, start.pose);
  poses[robot] = start.pose;
  ahead[robot].reset();
  retreated_to[robot].clear();
}

ExplorationState::Keys ExplorationState::free_at_start(std::size_t robot, const ExplorationStart& start,
                                                       const VoxelGrid& given) const {
  const BodyStencil body(travel_by_voxels(robot), lattice().resolution());
  const auto at = lattice().key(start.pose.position);
  Keys free = start.known_free;
  std::erase_if(free, [&](const VoxelKey& key) {
    return given.at(key) == Occupancy::kOccupied && !(at && body.contains(*at, key));
  });
  return free;
}

void ExplorationState::tell_of_given_map(const VoxelGrid& given, ExplorationStep& step) {
  if (!given.known_bounds()) return;
  std::vector<VoxelChange>& changed = step.robots.front().changed;
  Keys own;
  for (VoxelChange& change : changed) {
    change.before = Occupancy::kUnknown;
    own.push_back(change.key);
  }
  std::ranges::sort(own);
  for (const Occupancy state : {Occupancy::kFree, Occupancy::kOccupied})
    for (const VoxelKey& key : keys_in(given, state))
      if (!std::ranges::binary_search(own, key)) changed.push_back({key, Occupancy::kUnknown, state});
  std::ranges::sort(changed, {}, &VoxelChange::key);
}

// Lines 1 and 2.
void ExplorationState::look_around(std::span<const ExplorationStart> starts, const Drive& drive,
                                   ExplorationStep& step) {
  const PhaseClock clock(step, Phase::kMoving);
  const VoxelGrid given = mapping.grid();
  for (std::size_t r = 0; r < size(); ++r) {
    RobotStep& robot = step.robots[r];
    robot.path = PathOutcome::kInPlace;
    robot.planned = {starts[r].pose};  // nothing is measured at a path's first viewpoint
    for (Pose look : planner::look_around(options.team[r].robot.view, starts[r].pose)) {
      look.yaw = wrapped(look.yaw);
      robot.planned.push_back(look);
    }
    if (robot.planned.size() > 2) robot.planned.push_back(starts[r].pose);  // it goes on from how it stood
    execute_path(r, robot, nullptr, drive, mapping, free_at_start(r, starts[r], given));
    remember(r, robot);
  }
}

// Brings up to date what answers questions about the map, but for the selection's own corridors.
void ExplorationState::update_views(ExplorationStep& step) {
  {
    const PhaseClock clock(step, Phase::kFrontiers);
    for (std::size_t r = 0; r < size(); ++r)
      if (const auto cell = lattice().key(poses[r].position); cell && voxel_corridors[r])
        voxel_corridors[r]->update(change(), *cell);
  }
  const PhaseClock clock(step, Phase::kCaster);
  caster->update(mapping.grid());
}

// Lines 4 and 5.
void ExplorationState::select_goals(ExplorationStep& step, std::optional<std::size_t> choosing) {
  Keys large;
  {
    const PhaseClock clock(step, Phase::kFrontiers);
    wanted = abandoned.without_abandoned(frontiers.keys());
    large = in_large_clusters(frontiers, wanted, options.min_cluster_size);
  }
  TeamGoals goals;
  {
    const PhaseClock clock(step, Phase::kGoals);
    const auto has_goal = [](const Goal& goal) { return goal.pose.has_value(); };
    goals = selection->select(*caster, change(), large, poses, choosing);
    step.rays += goals.rays;
    if (large.size() < wanted.size() && std::ranges::none_of(goals.goals, has_goal)) {
      goals = selection->select(*caster, {mapping.grid()}, wanted, poses, choosing);
      step.rays += goals.rays;
    }
  }
  unassigned = goals.unassigned;
  for (std::size_t r = 0; r < size(); ++r) {
    if (choosing && *choosing != r) continue;
    targets[r].assign(selection->targets(r).begin(), selection->targets(r).end());
    step.robots[r].goal = std::move(goals.goals[r]);
    const bool on_plane = options.team[r].robot.travel.motion == Motion::kPlane;
    std::vector<RenderedCell> cells = selection->rendered_cells(r);
    step.robots[r].image =
        on_plane ? std::move(cells) : best_candidates(std::move(cells), step.robots[r].goal);
  }
  note_assignment(step);
}

void ExplorationState::note_assignment(ExplorationStep& step) {
  for (std::size_t r = 0; r < size(); ++r) {
    const Keys& now = tours ? tours->frontiers_of(r) : targets[r];
    Keys& reassigned = step.robots[r].reassigned;
    reassigned.clear();
    std::ranges::set_symmetric_difference(assigned[r], now, std::back_inserter(reassigned));
    if (!reassigned.empty()) assigned[r] = now;
  }
}

void ExplorationState::update_corridor(std::size_t robot, ExplorationStep& step, CorridorExtent extent) {
  const PhaseClock clock(step, Phase::kGoals);
  selection->update_corridor(change(), robot, poses[robot], extent);
}

void ExplorationState::count_frontiers(ExplorationStep& step) const {
  const PhaseClock clock(step, Phase::kFrontiers);
  const Keys left = abandoned.without_abandoned(frontiers.keys());
  step.frontiers = frontiers.size();
  step.abandoned = step.frontiers - left.size();
  step.unassigned = std::min(unassigned, left.size());
  if (!tours) return;
  step.unassigned = left.size();
  for (std::size_t r = 0; r < size(); ++r) {
    Keys own;
    std::ranges::set_intersection(tours->frontiers_of(r), left, std::back_inserter(own));
    step.unassigned -= own.size();
  }
}

// What the other robots are going to see.
ExplorationState::Keys ExplorationState::frontiers_of_others(std::size_t robot) const {
  Keys all;
  for (std::size_t r = 0; r < size(); ++r) {
    if (r == robot) continue;
    const Keys& keys = tours ? tours->frontiers_of(r) : targets[r];
    all.insert(all.end(), keys.begin(), keys.end());
  }
  std::ranges::sort(all);
  return all;
}

// Line 6.
void ExplorationState::plan_paths(ExplorationStep& step) {
  const PhaseClock clock(step, Phase::kPaths);
  for (std::size_t r = 0; r < size(); ++r) {
    RobotStep& robot = step.robots[r];
    if (!robot.goal.pose) {
      robot.planned = plan_retreat(r, robot.goal);
      robot.path = robot.planned.empty() ? PathOutcome::kNoCorridor : PathOutcome::kFound;
      continue;
    }
    retreated_to[r].clear();
    PathPlan plan = plan_path(path_corridor(r), lattice(), poses[r], *robot.goal.pose,
                              {options.seed, number, r}, options.path);
    robot.path = plan.outcome;
    robot.planned = std::move(plan.viewpoints);
  }
}

// Line 7.
ExplorationState::Gains ExplorationState::optimize_paths(ExplorationStep& step) const {
  const PhaseClock clock(step, Phase::kOptimization);
  Gains gains(size());
  for (std::size_t r = 0; r < size(); ++r)
    if (std::vector<Pose>& path = step.robots[r].planned; step.robots[r].goal.pose && !path.empty())
      gains[r] = optimize_path(r, path, step);
  return gains;
}

InformationGain ExplorationState::optimize_path(std::size_t r, std::vector<Pose>& path,
                                                ExplorationStep& step) const {
  PathOptimizerOptions turning = options.optimizer;
  if (!options.optimize) {
    turning.start = YawStart::kTangent;
    turning.ascend = false;
  }
  if (tours) {
    // It plans too often for a closer optimum to pay, and turns no faster than it can.
    const MotionLimits& limits = options.team[r].robot.limits;
    turning.ascend = false;
    turning.max_yaw_rate = limits.yaw_rate / limits.speed;
  }
  const CountingRayCaster counting(*caster, lattice());
  RobotStep& robot = step.robots[r];
  const FieldOfView& view = options.team[r].robot.view;
  // Without tours what is in view is told by its place among all targets.
  const Keys near = tours ? frontiers_near_path(lattice(), targets[r], path, view.max_range) : targets[r];
  const auto target_centers = centers(lattice(), near);
  const VisiblePairs pairs = visible_pairs(counting, mapping.grid(), path, near, view);
  const OptimizedPath turned = planner::optimize_path(path, target_centers, pairs, view, turning);
  for (std::size_t i = 1; i + 1 < path.size(); ++i) path[i].yaw = turned.yaws[i];
  robot.gain_tangent = turned.tangent.distinct;
  robot.gain_predicted = turned.result.distinct;
  step.rays += counting.rays();
  InformationGain gain(path, target_centers, pairs, view, options.optimizer.gain);
  robot.gain_sum = 0;
  for (std::size_t i = 0; i < path.size(); ++i)
    robot.gain_sum += frontiers_in_view(gain, i, path[i].yaw).size();
  return gain;
}

// Lines 8 to 11.
void ExplorationState::execute_paths(const Gains& gains, const Drive& drive, ExplorationStep& step) {
  const PhaseClock clock(step, Phase::kMoving);
  for (std::size_t r = 0; r < size(); ++r) {
    RobotStep& robot = step.robots[r];
    // A retreat need not be free: the robot came on it.
    const BodyStencil* body = robot.goal.pose ? &path_corridor(r).stencil() : nullptr;
    const std::size_t reached = execute_path(r, robot, body, drive, mapping);
    robot.gained = mapped_frontiers(robot.changed);
    if (gains[r])
      robot.still_unknown =
          find_still_unknown(mapping.grid(), *gains[r], std::span(robot.planned).first(reached), targets[r]);
    remember(r, robot);
  }
}

// Repeats recorded paths. False if the robots do not map what they mapped then.
bool ExplorationState::execute_again(const ExplorationStep& recorded, const Drive& drive,
                                     ExplorationStep& step) {
  // Where a retreat led cannot be told from its path: a look at an obstacle may have taken its end's place.
  for (std::size_t r = 0; r < size(); ++r) {
    const RobotStep& then = recorded.robots[r];
    if (then.goal.pose)
      retreated_to[r].clear();
    else if (!then.planned.empty() && !note_retreat(r, then.goal))
      return false;
  }
  for (std::size_t r = 0; r < size(); ++r) {
    const RobotStep& then = recorded.robots[r];
    if (then.travelled > then.planned.size()) return false;
    RobotStep& now = step.robots[r] = then;
    now.planned.resize(then.travelled);
    execute_path(r, now, nullptr, drive, mapping);
    if (now.travelled != then.travelled || now.changed != then.changed) return false;
    remember(r, then);
  }
  return true;
}

std::uint64_t ExplorationState::mapped_frontiers(std::span<const VoxelChange> changes) const {
  return static_cast<std::uint64_t>(std::ranges::count_if(changes, [&](const VoxelChange& voxel) {
    return voxel.before == Occupancy::kUnknown && frontiers.contains(voxel.key);
  }));
}

void ExplorationState::block(std::size_t robot, std::span<const VoxelKey> cells) {
  selection->block(robot, cells);
  if (voxel_corridors[robot]) voxel_corridors[robot]->block(cells);
  if (tours) tours->note_changed_voxels(robot, cells);
}

// What a robot's part of a step leaves behind.
void ExplorationState::remember(std::size_t robot, const RobotStep& step) {
  abandoned.visited(step.still_unknown);
  if (!step.blocked.empty()) block(robot, step.blocked);
  for (std::size_t i = trails[robot].empty() ? 0 : 1; i < step.travelled; ++i)
    trails[robot].push_back(step.planned[i]);
  if (step.travelled > 0) poses[robot] = step.planned[step.travelled - 1];
}

// All robots wait for the slowest. The first step has no planning.
void ExplorationState::advance_clock(ExplorationStep& step) {
  double longest = 0.0;
  for (std::size_t r = 0; r < size(); ++r) {
    const RobotStep& robot = step.robots[r];
    longest = std::max(longest, stop_and_go_time(std::span(robot.planned).first(robot.travelled),
                                                 options.team[r].robot.limits));
  }
  time += longest + (number == 0 ? 0.0 : options.latency);
  step.time = time;
}

void ExplorationState::update_frontiers(ExplorationStep& step) {
  const PhaseClock clock(step, Phase::kFrontiers);
  std::vector<VoxelChange> all;
  for (const RobotStep& robot : step.robots)
    all.insert(all.end(), robot.changed.begin(), robot.changed.end());
  std::ranges::stable_sort(all, {}, &VoxelChange::key);
  changed.clear();
  for (auto first = all.begin(), next = first; first != all.end(); first = next) {
    while (next != all.end() && next->key == first->key) ++next;
    // A robot may undo what another has changed.
    if (std::prev(next)->after != first->before) changed.push_back(first->key);
  }
  changed.insert(changed.end(), also_changed.begin(), also_changed.end());
  if (!std::exchange(also_changed, {}).empty()) sort_once(changed);
  const VoxelGrid& map = conservative_map ? conservative_map->grid() : mapping.grid();
  frontiers.update({map, changed});
  abandoned.forget_known(changed, map);
  if (tours) tours->note_changed_voxels(changed);
}

// What a path is expected to see, as `epsilon` measures it.
double ExplorationState::path_gain(const RobotStep& robot) const {
  const bool sum = options.optimizer.gain.mode == GainMode::kSum;
  return static_cast<double>(sum ? robot.gain_sum : robot.gain_predicted);
}

// A step in which a robot goes back is none of low gain.
void ExplorationState::count_low_gain(const ExplorationStep& step) {
  double expected_gain = 0.0;
  bool retreats = false;
  for (const RobotStep& robot : step.robots) {
    if (robot.travelled <= 1) continue;
    if (robot.goal.pose)
      expected_gain += path_gain(robot);
    else
      retreats = true;
  }
  if (expected_gain >= options.epsilon)
    low_gain_steps = 0;
  else if (!retreats)
    ++low_gain_steps;
}

// Line 3.
void ExplorationState::end_step(const ExplorationStep& step) {
  last_goals.clear();
  for (const RobotStep& robot : step.robots) last_goals.push_back(robot.goal);
  nothing_to_do = std::ranges::none_of(
      step.robots, [](const RobotStep& robot) { return robot.goal.pose || robot.travelled > 1; });
  count_low_gain(step);
  ++number;
}

}  // namespace frontlux::planner::detail
