// Goals at the first stops of the robots' tours.

#include "casting/counting_ray_caster.hpp"
#include "exploration/best_candidates.hpp"
#include "exploration/exploration_state.hpp"
#include "exploration/phase_clock.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// Why what is left is in no tour.
// @param gain      [frontiers] that a robot sees at least from a stop
// @param given_up  frontiers
std::string describe(const TourPlanning::Left& left, double gain, std::size_t given_up) {
  std::string text;
  const auto add = [&](std::size_t count, const std::string& where) {
    if (count > 0)
      text.append(text.empty() ? "; frontiers that are left: " : ", ").append(std::to_string(count)) += where;
  };
  add(left.small, " in clusters of fewer than " + std::to_string(left.enough));
  add(left.unseen, " in clusters of which no robot sees " +
                       std::to_string(static_cast<int>(std::ceil(gain))) + " from where it can get to");
  add(given_up, " given up");
  return text;
}

}  // namespace

// What a robot needs to know of its corridor as long as it has somewhere to go: all distances where finding
// them takes a few milliseconds, since they are exact.
CorridorExtent ExplorationState::extent_of_tours(std::size_t robot) const {
  constexpr std::uint64_t kFew = 1'000'000;  // cells
  const TravelOptions& travel = options.team[robot].robot.travel;
  const bool samples = options.path.search != PathSearch::kCorridor;  // among the cells
  const bool all = travel.motion == Motion::kPlane || samples || size_of(mapping.bounds()) <= kFew;
  return all ? CorridorExtent::kAllCells : CorridorExtent::kNearby;
}

// Of a long path only the first part is planned voxel by voxel: the robot plans again long before its end.
bool ExplorationState::find_path_to_stop(std::size_t robot, const VoxelKey& cell, ExplorationStep& step) {
  constexpr double kAhead = 80.0, kVoxelsAhead = 267.0;  // [m], the search takes time with voxels
  const PhaseClock clock(step, Phase::kPaths);
  const auto near_path = tours->around_path_to(robot, cell);
  ahead[robot].reset();
  if (const auto here = lattice().key(poses[robot].position))
    ahead[robot] =
        tours->cell_on_path_to(robot, cell, *here, std::min(kAhead, kVoxelsAhead * lattice().resolution()));
  if (ahead[robot] && selection->find_path(robot, *ahead[robot], near_path)) return true;
  ahead[robot].reset();
  return selection->find_path(robot, cell, near_path);
}

// What the robot's yaws are chosen for: what is left, but not to others.
void ExplorationState::set_targets(std::size_t robot) {
  targets[robot].clear();
  std::ranges::set_difference(wanted, frontiers_of_others(robot), std::back_inserter(targets[robot]));
}

bool ExplorationState::keep_stop(std::size_t robot, ExplorationStep& step) {
  update_corridor(robot, step, extent_of_tours(robot));
  {
    const PhaseClock clock(step, Phase::kGoals);
    wanted = abandoned.without_abandoned(frontiers.keys());
    set_targets(robot);
  }
  const VoxelKey& cell = step.robots[robot].goal.cell;
  if (find_path_to_stop(robot, cell, step)) return true;
  const PhaseClock clock(step, Phase::kPaths);
  return selection->find_path(robot, cell, [](const VoxelKey&) { return true; });
}

// The goal at the first stop of a robot's tour, or why there is none.
Goal ExplorationState::first_stop(std::size_t robot) const {
  Goal goal;
  const CorridorState corridor = path_corridor(robot).state();
  const auto tour = tours->tour(robot);
  if (corridor != CorridorState::kReady) {
    goal.state = GoalState::kNoCorridor;
    goal.reason = "no goal: the robot " + std::string(describe(corridor));
    return goal;
  }
  if (tour.empty()) {
    goal.state = GoalState::kNothingAssigned;
    goal.reason = std::string("no goal: there is nothing to see for it") +
                  (options.team.size() > 1 ? " that is not another robot's" : "") +
                  describe(tours->left(), tours->least_gain(robot), frontiers.keys().size() - wanted.size());
    return goal;
  }
  const TourStop& first = tour.front();
  goal.state = GoalState::kAssigned;
  goal.pose = first.pose;
  // A robot that sees all around looks where it goes.
  if (options.team[robot].robot.view.sees_all_around())
    goal.pose->yaw = yaw_along(first.pose.position - poses[robot].position, poses[robot].yaw);
  goal.cell = first.cell;
  goal.distance = tours->first_distance(robot);
  goal.gain = static_cast<double>(first.seen);
  goal.assigned = tours->frontiers_of(robot).size();
  goal.quality = options.team[robot].options.discount(goal.distance) * goal.gain;
  goal.reason =
      "stop 1 of " + std::to_string(tour.size()) + ", " + std::to_string(first.seen) + " frontiers in view";
  return goal;
}

void ExplorationState::plan_tours(std::size_t robot, std::span<const MotionState> starts,
                                  ExplorationStep& step) {
  const CountingRayCaster counting(*caster, lattice());
  {
    const PhaseClock clock(step, Phase::kGoals);
    wanted = abandoned.without_abandoned(frontiers.keys());
  }
  const auto update = [&](CorridorExtent extent) {
    update_corridor(robot, step, extent);
    const PhaseClock clock(step, Phase::kGoals);
    tours->update({robot, counting, mapping.grid(), path_corridor(robot), wanted, starts});
  };
  const auto has_path = [&] {
    const auto tour = tours->tour(robot);
    return tour.empty() || find_path_to_stop(robot, tour.front().cell, step);
  };
  update(extent_of_tours(robot));
  if (!has_path() && extent_of_tours(robot) == CorridorExtent::kNearby) update(CorridorExtent::kAllCells);
  step.rays += counting.rays();
  const GoalOptions& rating = options.team[robot].options;
  const PhaseClock clock(step, Phase::kGoals);
  set_targets(robot);
  const Goal& goal = step.robots[robot].goal = first_stop(robot);
  std::vector<RenderedCell> candidates = tours->candidates(robot);
  for (RenderedCell& cell : candidates) cell.quality = rating.discount(cell.distance) * cell.gain;
  step.robots[robot].image = best_candidates(std::move(candidates), goal);
}

}  // namespace frontlux::planner::detail
