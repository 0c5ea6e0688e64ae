#include "exploration/exploration_state.hpp"
#include "exploration/phase_clock.hpp"
#include "frontier/small_clusters.hpp"

#include <frontlux/planner/visible_pairs.hpp>

#include <algorithm>
#include <utility>

// Alg. 1, lines 4 to 7: where the robots go, and how they look on the way.
namespace frontlux::planner {

// Lines 4 and 5.
TeamGoals Exploration::State::select_goals(ExplorationStep& step) {
  const VoxelGrid& grid = mapping.grid();
  Keys wanted, large;
  {
    const detail::PhaseClock clock(step, Phase::kFrontiers);
    for (std::optional<TravelCorridor>& way : ways) {
      const auto robot = static_cast<std::size_t>(&way - ways.data());
      const auto cell = cell_at(poses[robot].position);
      if (way && cell) way->update(change(), *cell);
    }
    wanted = abandoned.without_abandoned(frontiers.keys());
    large = detail::in_large_clusters(frontiers, wanted, options.min_cluster_size);
    step.frontiers = frontiers.size();
    step.abandoned = frontiers.size() - wanted.size();
  }
  {
    const detail::PhaseClock clock(step, Phase::kCaster);
    caster->update(grid);
  }
  const detail::PhaseClock clock(step, Phase::kGoals);
  const auto has_goal = [](const Goal& goal) { return goal.pose.has_value(); };
  TeamGoals goals = selection->select(*caster, change(), large, poses);
  step.rays += goals.rays;
  if (large.size() < wanted.size() && std::none_of(goals.goals.begin(), goals.goals.end(), has_goal)) {
    goals = selection->select(*caster, {grid}, wanted, poses);
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

}  // namespace frontlux::planner
