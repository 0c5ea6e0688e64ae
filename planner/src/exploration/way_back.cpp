// The ways by which a robot without a goal goes back along its trail.

#include "exploration/exploration_state.hpp"

#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/planner/path_planner.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace frontlux::planner::detail {
namespace {

// A way that comes to no voxel twice.
std::vector<Pose> without_loops(const Lattice& lattice, std::span<const Pose> way) {
  std::map<std::optional<VoxelKey>, std::size_t> last;
  for (std::size_t i = 0; i < way.size(); ++i) last[lattice.key(way[i].position)] = i;
  std::vector<Pose> rest;
  for (std::size_t i = 0; i < way.size(); ++i) {
    rest.push_back(way[i]);
    const std::size_t leaves = last[lattice.key(way[i].position)];
    if (leaves == i) continue;
    rest.push_back(way[leaves]);
    i = leaves;
  }
  return rest;
}

}  // namespace

// Whether a robot sees enough from somewhere that it can go to from a cell, to which its way has this length
// [m]. What other robots see anyhow is worth less from afar, as eq. 1 has it.
bool ExplorationState::worth_going_to(TravelCorridor& elsewhere, std::size_t robot, const VoxelKey& cell,
                                      double length) const {
  elsewhere.update({mapping.grid()}, cell);
  const FrontierAgent there{elsewhere.cells(), options.team[robot].robot.view};
  const Keys others = frontiers_of_others(robot);
  const double from_afar = std::exp(-options.team[robot].options.lambda * length);
  double gain = 0.0;
  for (const std::uint32_t i : find_visible_frontiers(*caster, mapping.grid(), wanted, there).frontiers)
    gain += std::ranges::binary_search(others, wanted[i]) ? from_afar : 1.0;
  return gain > 0.0 && gain >= options.epsilon;
}

// A robot beside which a closer look has found something is in no corridor; it goes back to the last place
// that is in one. Behind a passage that a closer look has closed its corridor holds nothing to see; it goes
// back through the passage, if there is something to see from beyond.
std::vector<Pose> ExplorationState::way_back(std::size_t robot, const Goal& goal, const Keys& tried) const {
  const std::vector<Pose>& trail = trails[robot];
  const TravelCorridor& corridor = path_corridor(robot);
  const bool lost = goal.state == GoalState::kNoCorridor;
  TravelOptions by_voxels = options.team[robot].robot.travel;
  by_voxels.node_edge = 0.0;
  std::optional<TravelCorridor> elsewhere;
  for (auto place = trail.rbegin(); place != trail.rend(); ++place) {
    const auto cell = lattice().key(place->position);
    if (!cell || !corridor.passable(*cell)) continue;
    if (corridor.extent() == CorridorExtent::kAllCells ? corridor.contains(*cell)
                                                       : tours->gets_to(robot, *cell))
      continue;
    if (lost && place->position == poses[robot].position) return {};
    if (std::ranges::find(tried, *cell) != tried.end()) continue;
    if (!lost) {
      if (elsewhere && elsewhere->contains(*cell)) continue;
      if (!elsewhere) elsewhere.emplace(by_voxels, lattice(), mapping.bounds());
    }
    std::vector<Pose> way = without_loops(lattice(), std::vector<Pose>(trail.rbegin(), place + 1));
    if (lost || worth_going_to(*elsewhere, robot, *cell, path_length(way))) return way;
  }
  return {};
}

// To each place once for each goal that the robot had, or it would go back and forth, or try for ever.
std::vector<Pose> ExplorationState::take_way_back(std::size_t robot, const Goal& goal) {
  std::vector<Pose> way = way_back(robot, goal, went_back_to[robot]);
  if (!way.empty()) went_back_to[robot].push_back(lattice().key(way.back().position).value());
  return way;
}

bool ExplorationState::is_cut_off(std::size_t robot, const Goal& goal) const {
  if (goal.state == GoalState::kNoCorridor)  // where it started it has been put
    return std::ranges::any_of(trails[robot],
                               [&](const Pose& place) { return place.position != poses[robot].position; });
  return !went_back_to[robot].empty() && !way_back(robot, goal, {}).empty();
}

}  // namespace frontlux::planner::detail
