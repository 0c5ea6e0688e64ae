#include "tour/tour_planning.hpp"

#include "corridor/whole_voxels.hpp"
#include "mapping/cubes_of_keys.hpp"
#include "routing/idle_robots.hpp"
#include "tour/travel_seconds.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace frontlux::planner::detail {
namespace {

using Keys = std::vector<VoxelKey>;

constexpr double kClusterEdge = 0.4;  // [longest range] of the cubes that cut clusters
constexpr double kZoneEdge = 0.8;     // [longest range] of a zone, whose far clusters make one stop
constexpr double kGraphEdge = 0.2;    // [longest range] of the graph's cubes
constexpr double kSpacing = 0.05;     // [own range] between the cells that are tried all over the graph

int voxels(double length, const Lattice& lattice) {
  return std::max(1, static_cast<int>(std::lround(length / lattice.resolution())));
}

// The cells of a robot on a plane are all on one layer.
KeyBox cells_of(const Robot& robot, const Pose& start, const Lattice& lattice, const KeyBox& bounds) {
  KeyBox cells = bounds;
  if (robot.travel.motion == Motion::kPlane)
    cells.min.z = cells.max.z = lattice.key(start.position.z()).value_or(bounds.min.z);
  return cells;
}

double greatest_range(std::span<const Robot> robots) {
  double greatest = 0.0;
  for (const Robot& robot : robots) greatest = std::max(greatest, robot.view.max_range);
  return greatest;
}

}  // namespace

TourPlanning::TourPlanning(std::vector<Robot> robots, std::span<const Pose> starts, const Lattice& lattice,
                           const KeyBox& bounds, const Options& options)
    : lattice_(lattice),
      bounds_(bounds),
      options_(options),
      graph_edge_(voxels(kGraphEdge * greatest_range(robots), lattice)),
      zone_edge_(voxels(kZoneEdge * greatest_range(robots), lattice)),
      clusters_(bounds, voxels(kClusterEdge * greatest_range(robots), lattice), least_frontiers(lattice)) {
  for (std::size_t r = 0; r < robots.size(); ++r)
    members_.push_back(new_member(std::move(robots[r]), starts[r]));
}

TourPlanning::Member TourPlanning::new_member(Robot robot, const Pose& start) const {
  TravelGraph graph(lattice_, cells_of(robot, start, lattice_, bounds_), graph_edge_,
                    voxels(kSpacing * robot.view.max_range, lattice_));
  ViewRegion region(robot.view, lattice_.resolution());
  return {std::move(robot), std::move(region), {lattice_, std::move(graph), options_.measured}};
}

void TourPlanning::note_changed_voxels(std::span<const VoxelKey> changed) {
  for (std::size_t r = 0; r < members_.size(); ++r) note_changed_voxels(r, changed);
}

void TourPlanning::note_changed_voxels(std::size_t robot, std::span<const VoxelKey> changed) {
  Member& member = members_[robot];
  if (!member.lost) member.changed.insert(member.changed.end(), changed.begin(), changed.end());
}

// Only its own plannings give a robot viewpoints.
void TourPlanning::lose(std::size_t robot) {
  Member& member = members_[robot];
  member.lost = true;
  member.changed = {};
  member.sights = {};
  member.tour.clear();
  member.going_for.clear();
  member.frontiers.clear();
  member.first_view.clear();
}

void TourPlanning::join(std::size_t robot, const Pose& pose) {
  members_[robot] = new_member(members_[robot].robot, pose);
}

double TourPlanning::first_distance(std::size_t robot) const {
  const Member& member = members_[robot];
  const double distance = member.tour.empty() ? 0.0 : member.distances.from_start(member.tour.front().cell);
  return distance == TourProblem::kNever ? 0.0 : distance;
}

std::vector<RenderedCell> TourPlanning::candidates(std::size_t robot) const {
  const Member& member = members_[robot];
  std::vector<RenderedCell> cells;
  for (const FrontierCluster& cluster : clusters_.clusters())
    for (const auto& [cell, yaw, seen, aim] : member.sights.viewpoints(cluster.id))
      if (const double distance = member.distances.from_start(cell); distance != TourProblem::kNever)
        cells.push_back({.cell = cell,
                         .distance = distance,
                         .gain = static_cast<double>(seen),
                         .yaw = yaw,
                         .hits = static_cast<std::uint32_t>(seen)});
  return cells;
}

std::function<bool(const VoxelKey&)> TourPlanning::around_path_to(std::size_t robot,
                                                                  const VoxelKey& to) const {
  return members_[robot].distances.around_path_to(to);
}

// Boxes that hold all voxels that have changed since the robot's last planning.
std::vector<KeyBox> TourPlanning::take_changes(Member& member) const {
  std::vector<KeyBox> boxes;
  for (const VoxelKey& cube : cubes_of(std::exchange(member.changed, {})))
    boxes.push_back(voxels_of_cube(cube));
  return boxes;
}

// @return boxes that hold the changes and all cells in which the robot fits only now, or not any more
std::vector<KeyBox> TourPlanning::update_distances(const Query& query, std::span<const KeyBox> changes) {
  Member& member = members_[query.robot];
  const auto [x, y, z] = deciding_reach(member.robot.travel, lattice_.resolution());
  std::vector<KeyBox> cells;  // which a changed voxel may open or close
  for (const KeyBox& box : changes) cells.push_back(grown(box, x + 1, y + 1, z + 1));
  member.distances.update(query.corridor, cells);
  return cells;
}

// Of the robot that plans: exact near by.
double TourPlanning::own_distance_to(const Query& query, const VoxelKey& cell) const {
  if (const auto distance = query.corridor.distance(cell)) return *distance;
  return query.corridor.extent() == CorridorExtent::kAllCells
             ? TourProblem::kNever
             : members_[query.robot].distances.from_start(cell);
}

// Other robots may keep it closed only if the corridor knows its cells.
bool TourPlanning::reaches(const Query& query, const VoxelKey& cell) const {
  return query.corridor.extent() == CorridorExtent::kAllCells
             ? query.corridor.contains(cell)
             : query.corridor.passable(cell) && can_reach(query.robot, cell);
}

bool TourPlanning::can_reach(std::size_t robot, const VoxelKey& cell) const {
  return members_[robot].distances.reaches(cell);
}

std::optional<VoxelKey> TourPlanning::place_to_see_from(
    std::size_t robot, const RayCaster& caster, const VoxelGrid& grid,
    const std::function<bool(const VoxelKey&)>& among) const {
  // What others come to later it may see before them.
  const auto is_others = [&](const FrontierCluster& cluster) {
    for (std::size_t r = 0; r < members_.size(); ++r)
      if (r != robot && std::ranges::find(members_[r].going_for, cluster.id) != members_[r].going_for.end())
        return true;
    return false;
  };
  const ViewpointQuery view = sight_of(robot, caster, grid);
  for (const FrontierCluster& cluster : clusters_.clusters()) {
    if (is_others(cluster)) continue;
    const auto viewpoints = viewpoints_anywhere(view, cluster, Aim::kMiddle, among);
    if (!viewpoints.empty()) return viewpoints.front().cell;
  }
  return std::nullopt;
}

ViewpointQuery TourPlanning::sight_of(std::size_t robot, const RayCaster& caster,
                                      const VoxelGrid& grid) const {
  const Member& member = members_[robot];
  return {caster, grid, member.distances.graph(), member.robot.view, member.region, least_gain(robot)};
}

// Of a robot in motion, to a viewpoint at a distance [m] on its path.
double TourPlanning::seconds_to(const Robot& robot, const MotionState& start,
                                const ClusterViewpoint& viewpoint, double distance) const {
  constexpr double kReluctance = 2.0;  // to change direction; the time that it takes would be 1
  const Eigen::Vector3d offset = lattice_.exact_center(viewpoint.cell) - start.pose.position;
  const double time = travel_seconds(robot, distance, offset, turn_between(start.pose.yaw, viewpoint.yaw));
  if (offset.isZero()) return time;
  const double lost = start.velocity.norm() - start.velocity.dot(offset.normalized());
  return time + kReluctance * lost / robot.limits.acceleration;
}

const ClusterViewpoint* TourPlanning::best_viewpoint(const Member& member, std::uint32_t cluster) const {
  const auto viewpoints = member.sights.viewpoints(clusters_.clusters()[cluster].id);
  return viewpoints.empty() ? nullptr : &viewpoints.front();
}

// The distances, the clusters, and from where the robot sees them.
void TourPlanning::update_map(const Query& query) {
  Member& member = members_[query.robot];
  std::vector<KeyBox> changes = take_changes(member);
  if (!std::exchange(member.planned, true))
    if (const auto known = query.grid.known_bounds()) changes.assign(1, *known);
  const std::vector<KeyBox> cells = update_distances(query, changes);
  for_each_index(members_.size() + 1, [&](std::size_t r) {
    if (r == members_.size())
      return clusters_.update(query.frontiers, openings(query.grid));  // at the same time
    // Another robot may be where there was no place when it made its tour. It starts from where it did then.
    const auto cell = lattice_.key(query.starts[r].pose.position);
    GraphDistances& distances = members_[r].distances;
    if (r == query.robot || (cell && distances.graph().fits(*cell))) distances.start_from(cell);
  });
  if (looks_closer()) lower_least_sizes(query.grid);
  const std::function<bool(const VoxelKey&)> can_go = [&](const VoxelKey& cell) {
    return reaches(query, cell);
  };
  const std::function<bool(const VoxelKey&)> connects = [&](const VoxelKey& cell) {
    return can_reach(query.robot, cell);
  };
  const bool can_move = query.corridor.state() == CorridorState::kReady;
  const auto sights = [&](const ViewpointQuery& view) {
    return ClusterSights::Query{view, clusters_.clusters(), cells, can_go, connects, can_move};
  };
  const ViewpointQuery view = sight_of(query.robot, query.caster, query.grid);
  member.sights.update(sights(view));
  member.sees_some = can_move ? member.sights.sees_any() : member.sees_some && !member.stuck;
  member.stuck = !can_move;
  if (!can_move) return;
  // A flat patch of unknown floor may be all that keeps a robot from where it would see something.
  if (!nobody_sees_any() && !member.sights.sees_any() && member.sights.would_see_any())
    member.sights.look_at_faces(sights(view));
  if (nobody_sees_any()) look_closer(query, sights);
}

// What is left of the tours before. Where another robot goes already, it goes: all that it is to see from
// there is fixed.
Tours TourPlanning::tours_before(const Query& query, std::span<const StopClusters> stops,
                                 TourProblem& problem) const {
  std::map<ClusterId, std::uint32_t> stop_of;
  for (std::uint32_t i = 0; i < stops.size(); ++i)
    for (const std::uint32_t cluster : stops[i]) stop_of[clusters_.clusters()[cluster].id] = i;
  Tours before(members_.size());
  std::vector<bool> taken(stops.size());
  const auto take = [&](std::size_t r, std::span<const ClusterId> ids) {
    for (const ClusterId id : ids) {
      const auto place = stop_of.find(id);
      if (place == stop_of.end() || taken[place->second] ||
          problem.robots[r].first[place->second] == TourProblem::kNever)
        continue;
      taken[place->second] = true;
      before[r].push_back(place->second);
    }
  };
  for (std::size_t r = 0; r < members_.size(); ++r) {
    if (r == query.robot) continue;
    take(r, members_[r].going_for);
    problem.robots[r].fixed = before[r].size();
    problem.robots[r].rests = members_[r].planned && !members_[r].lost && members_[r].going_for.empty();
  }
  for (std::size_t r = 0; r < members_.size(); ++r)
    for (const TourStop& stop : members_[r].tour) take(r, stop.clusters);
  return before;
}

// The tours before, shortened, unless tours from nothing are better by a margin: else robots would change
// their minds all the time.
Tours TourPlanning::shared_out(const TourProblem& problem, const Tours& before) {
  constexpr double kReplaceBelow = 0.95;  // of the cost before
  std::array<Tours, 2> tours{before, Tours(before.size())};
  for (std::size_t r = 0; r < before.size(); ++r)
    tours[1][r].assign(before[r].begin(),
                       before[r].begin() + static_cast<std::ptrdiff_t>(problem.robots[r].fixed));
  for_each_index(2, [&](std::size_t i) { tours[i] = shortened_tours(problem, std::move(tours[i])); });
  const bool anew = cost_of(problem, tours[1]) < kReplaceBelow * cost_of(problem, tours[0]);
  return tours[anew ? 1 : 0];
}

// In the place of tours: that of the robot is the nearest stop to which no other robot is going.
Tours TourPlanning::nearest_stop(const TourProblem& problem, const Tours& before, std::size_t robot) {
  Tours tours(before.size());
  std::vector<bool> taken(problem.stops);
  for (std::size_t r = 0; r < before.size(); ++r)
    for (std::size_t i = 0; r != robot && i < problem.robots[r].fixed; ++i) {
      tours[r].push_back(before[r][i]);
      taken[before[r][i]] = true;
    }
  std::optional<std::uint32_t> nearest;
  const std::vector<double>& seconds = problem.robots[robot].first;
  for (std::uint32_t stop = 0; stop < problem.stops; ++stop)
    if (!taken[stop] && seconds[stop] < (nearest ? seconds[*nearest] : TourProblem::kNever)) nearest = stop;
  if (nearest) tours[robot].push_back(*nearest);
  return tours;
}

// A stop for each cluster, until the robot that plans joins its next ones.
void TourPlanning::set_tours(const Query& query, std::span<const StopClusters> stops, const Tours& tours) {
  for (std::size_t r = 0; r < members_.size(); ++r) {
    Member& member = members_[r];
    std::vector<TourStop> tour;
    Eigen::Vector3d at = query.starts[r].pose.position;
    for (const std::uint32_t place : tours[r])
      for (const std::uint32_t cluster : in_order(member, stops[place], at)) {
        const ClusterViewpoint& viewpoint = *best_viewpoint(member, cluster);
        at = lattice_.exact_center(viewpoint.cell);
        tour.push_back(
            {{clusters_.clusters()[cluster].id}, {at, viewpoint.yaw}, viewpoint.cell, viewpoint.seen});
      }
    member.tour = std::move(tour);
  }
}

// Of all tours, and of the first stop of the robot that plans.
void TourPlanning::note_frontiers(const Query& query) {
  std::unordered_map<ClusterId, Member*> whose;
  for (Member& member : members_) {
    member.frontiers.clear();
    for (const TourStop& stop : member.tour)
      for (const ClusterId id : stop.clusters) whose[id] = &member;
  }
  std::vector<ClusterId> ids(query.frontiers.size());
  for_each_index(ids.size(), [&](std::size_t i) { ids[i] = clusters_.cluster_of(query.frontiers[i]); });
  left_ = {.enough = clusters_.least()};
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (const auto owner = whose.find(ids[i]); owner != whose.end())
      owner->second->frontiers.push_back(query.frontiers[i]);
    else
      ++(ids[i] == ClusterId::kNone ? left_.small : left_.unseen);
  Member& member = members_[query.robot];
  member.first_view.clear();
  if (member.tour.empty()) return;
  const TourStop& first = member.tour.front();
  const ViewpointQuery view = sight_of(query.robot, query.caster, query.grid);
  for (const ClusterId id : first.clusters) {
    const Keys seen = visible_from(view, clusters_.cluster(id).keys, first.cell, first.pose.yaw,
                                   member.sights.viewpoints(id).front().aim);
    member.first_view.insert(member.first_view.end(), seen.begin(), seen.end());
  }
  std::ranges::sort(member.first_view);
}

void TourPlanning::update(const Query& query) {
  update_map(query);
  const std::vector<StopClusters> places = stop_places(query);
  TourProblem all = problem(query, places);
  const Tours before = tours_before(query, places, all);
  Tours tours =
      options_.without == TourPart::kTours ? nearest_stop(all, before, query.robot) : shared_out(all, before);
  give_idle_robot_a_stop(all, query.robot, tours);
  set_tours(query, places, tours);
  join_next_stops(query);
  Member& member = members_[query.robot];
  member.going_for = member.tour.empty() ? std::vector<ClusterId>{} : member.tour.front().clusters;
  note_frontiers(query);
}

}  // namespace frontlux::planner::detail
