// The path on which a robot without a goal retreats along its trail.

#include "exploration/exploration_state.hpp"

#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>

namespace frontlux::planner::detail {
namespace {

// The voxels that a body fills: nothing else can be in them.
bool fills(const Eigen::AlignedBox3d& body, const Lattice& lattice, const VoxelKey& voxel) {
  const Eigen::Vector3d middle = lattice.exact_center(voxel),
                        half = Eigen::Vector3d::Constant(lattice.resolution() / 2);
  return body.contains(Eigen::AlignedBox3d(middle - half, middle + half));
}

// Whether the sensor of a robot would go through a voxel that is known to be occupied, but for its own one
// and those that its body fills.
bool leads_through_occupied(const VoxelGrid& map, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                            const std::optional<VoxelKey>& own, const Eigen::AlignedBox3d& body) {
  const Lattice& lattice = map.lattice();
  return !SegmentVoxels(lattice, from, to).all_of([&](const VoxelKey& key) {
    return key == own || map.at(key) != Occupancy::kOccupied || fills(body, lattice, key);
  });
}

// A path that comes to no voxel twice.
std::vector<Pose> without_loops(const Lattice& lattice, std::span<const Pose> path) {
  std::map<std::optional<VoxelKey>, std::size_t> last;
  for (std::size_t i = 0; i < path.size(); ++i) last[lattice.key(path[i].position)] = i;
  std::vector<Pose> rest;
  for (std::size_t i = 0; i < path.size(); ++i) {
    rest.push_back(path[i]);
    const std::size_t leaves = last[lattice.key(path[i].position)];
    if (leaves == i) continue;
    rest.push_back(path[leaves]);
    i = leaves;
  }
  return rest;
}

}  // namespace

// As the robot's own, without the cells that it found blocked, before an update and wherever others are.
TravelCorridor ExplorationState::corridor_elsewhere(std::size_t robot) const {
  TravelCorridor elsewhere(travel_by_voxels(robot), lattice(), mapping.bounds());
  elsewhere.block(path_corridor(robot).blocked());
  return elsewhere;
}

// Whether a robot would have a goal if it were in a cell, to which its path has this length [m]. Without
// tours what other robots see anyhow is worth less from afar, as eq. 1 has it.
bool ExplorationState::would_have_goal_at(TravelCorridor& elsewhere, std::size_t robot, const VoxelKey& cell,
                                          double length) const {
  elsewhere.update({travel_map()}, cell);
  if (tours)
    return tours
        ->place_to_see_from(robot, *caster, mapping.grid(),
                            [&](const VoxelKey& key) { return elsewhere.contains(key); })
        .has_value();
  const FrontierAgent there{elsewhere.cells(), options.team[robot].robot.view};
  const Keys others = frontiers_of_others(robot);
  const double from_afar = options.team[robot].options.discount(length);
  double gain = 0.0;
  for (const std::uint32_t i : find_visible_frontiers(*caster, mapping.grid(), wanted, there).frontiers)
    gain += std::ranges::binary_search(others, wanted[i]) ? from_afar : 1.0;
  return gain > 0.0 && gain >= options.epsilon;
}

bool ExplorationState::can_reach(std::size_t robot, const VoxelKey& cell) const {
  const TravelCorridor& corridor = path_corridor(robot);
  return corridor.extent() == CorridorExtent::kAllCells ? corridor.contains(cell)
                                                        : tours->can_reach(robot, cell);
}

// Whether a robot's body, wherever it is in its cell, covers the voxel that its sensor is in: nothing else
// can have been there when it came. A larger voxel may be occupied beside it.
bool ExplorationState::fills_its_voxel(std::size_t robot) const {
  const TravelOptions& travel = options.team[robot].robot.travel;
  const double below = -body_of(travel).min().z();
  return std::min(travel.extents.head<2>().minCoeff() / 2, below) >= lattice().resolution();
}

// A robot beside which a closer look has found something is in no corridor; it retreats to the last place
// that is in one. Behind a passage that a closer look has closed its corridor holds nothing to see; it
// retreats through the passage, if there is something to see from beyond. But where its sensor has been may
// be occupied by now: a door has been shut behind it.
std::optional<std::size_t> ExplorationState::place_to_retreat_to(std::size_t robot, const Goal& goal,
                                                                 const Keys& tried) const {
  const std::vector<Pose>& trail = trails[robot];
  const bool has_no_corridor = goal.state == GoalState::kNoCorridor;
  std::optional<TravelCorridor> elsewhere;
  const bool may_be_shut = fills_its_voxel(robot);
  const auto own = lattice().key(poses[robot].position);
  const Eigen::AlignedBox3d body =
      body_of(options.team[robot].robot.travel).translated(poses[robot].position);
  double length = 0.0;   // [m] of the trail from the place on
  bool is_shut = false;  // the trail, between the place and where the robot is, or what it can reach
  for (std::size_t place = trail.size(); place-- > 0;) {
    const auto cell = lattice().key(trail[place].position);
    const bool reached = cell && can_reach(robot, *cell);
    if (place + 1 < trail.size()) {
      const Eigen::Vector3d &here = trail[place].position, &next = trail[place + 1].position;
      length += (next - here).norm();
      is_shut = may_be_shut && !reached && cell != own &&
                (is_shut || leads_through_occupied(mapping.grid(), here, next, own, body));
    }
    if (!cell || is_shut || reached || !path_corridor(robot).passable(*cell)) continue;
    if (has_no_corridor && trail[place].position == poses[robot].position) return std::nullopt;
    if (std::ranges::find(tried, *cell) != tried.end()) continue;
    if (has_no_corridor) return place;
    if (elsewhere && elsewhere->contains(*cell)) continue;
    if (!elsewhere) elsewhere = corridor_elsewhere(robot);
    if (would_have_goal_at(*elsewhere, robot, *cell, length)) return place;
  }
  return std::nullopt;
}

// On a short path to where the robot has last left what it can get to; from there on, or if it can get
// nowhere, as it came.
std::vector<Pose> ExplorationState::retreat_to(std::size_t robot, std::size_t place) {
  const std::vector<Pose>& trail = trails[robot];
  const auto back_from = [&](std::size_t last) {
    const auto first = trail.begin() + static_cast<std::ptrdiff_t>(place);
    std::vector<Pose> path(first, trail.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    std::ranges::reverse(path);
    return without_loops(lattice(), path);
  };
  for (std::size_t i = place; i < trail.size(); ++i) {
    const auto cell = lattice().key(trail[i].position);
    if (!cell || !can_reach(robot, *cell)) continue;
    if (path_corridor(robot).extent() == CorridorExtent::kNearby &&
        !selection->find_path(robot, *cell, tours->around_path_to(robot, *cell)))
      break;
    std::vector<Pose> path = plan_path(path_corridor(robot), lattice(), poses[robot], trail[i],
                                       {options.seed, number, robot}, options.path)
                                 .viewpoints;
    if (path.empty()) break;
    const std::vector<Pose> rest = back_from(i);
    path.insert(path.end(), rest.begin(), rest.end());
    return path;
  }
  return back_from(trail.size() - 1);
}

// To each place once for each goal that the robot had, or it would go back and forth, or try for ever.
std::optional<std::size_t> ExplorationState::note_retreat(std::size_t robot, const Goal& goal) {
  const auto place = place_to_retreat_to(robot, goal, retreated_to[robot]);
  if (place) retreated_to[robot].push_back(lattice().key(trails[robot][*place].position).value());
  return place;
}

std::vector<Pose> ExplorationState::plan_retreat(std::size_t robot, const Goal& goal) {
  const auto place = note_retreat(robot, goal);
  return place ? retreat_to(robot, *place) : std::vector<Pose>{};
}

bool ExplorationState::is_cut_off(std::size_t robot, const Goal& goal) const {
  if (goal.state == GoalState::kNoCorridor)  // where it started it has been put
    return std::ranges::any_of(trails[robot],
                               [&](const Pose& place) { return place.position != poses[robot].position; });
  if (retreated_to[robot].empty()) return false;
  const auto place = place_to_retreat_to(robot, goal, {});
  if (!place) return false;
  // What has closed off a part that is smaller than that where it is has not locked it in.
  TravelCorridor elsewhere = corridor_elsewhere(robot);
  elsewhere.update({travel_map()}, lattice().key(trails[robot][*place].position).value());
  return !can_reach_as_many_as(robot, elsewhere.cells().size());
}

// Whether a robot can get to so many cells, wherever other robots are.
bool ExplorationState::can_reach_as_many_as(std::size_t robot, std::size_t count) const {
  const TravelCorridor& corridor = path_corridor(robot);
  const auto here = lattice().key(poses[robot].position);
  if (!here) return false;
  std::set<VoxelKey> known{*here};
  std::vector<VoxelKey> rest{*here};
  while (!rest.empty() && known.size() < count) {
    const VoxelKey at = rest.back();
    rest.pop_back();
    for_each_key(grown({at, at}, 1), [&](const VoxelKey& next) {
      const int apart = std::abs(next.x - at.x) + std::abs(next.y - at.y) + std::abs(next.z - at.z);
      if (apart == 1 && corridor.fits(next) && known.insert(next).second) rest.push_back(next);
    });
  }
  return known.size() >= count;
}

}  // namespace frontlux::planner::detail
