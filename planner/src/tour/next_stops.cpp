// The stops that come next in a robot's tour.

#include "routing/order_by_arrival.hpp"
#include "routing/shortest_choice.hpp"
#include "tour/tour_planning.hpp"
#include "tour/travel_seconds.hpp"

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {

// The nearest stops of the robot's tour before the others. The shortest tour may leave them for the end, and
// would come back for them from far away.
void TourPlanning::put_nearest_first(const Query& query) {
  std::vector<TourStop>& tour = members_[query.robot].tour;
  if (tour.size() <= options_.joined) return;
  std::vector<std::pair<double, std::size_t>> places;  // distance [m] and place of each stop
  for (std::size_t i = 0; i < tour.size(); ++i) places.emplace_back(own_distance_to(query, tour[i].cell), i);
  std::ranges::sort(places);
  std::vector<bool> near(tour.size());
  for (std::size_t i = 0; i < options_.joined; ++i) near[places[i].second] = true;
  std::vector<TourStop> stops;
  for (const bool nearest : {true, false})
    for (std::size_t i = 0; i < tour.size(); ++i)
      if (near[i] == nearest) stops.push_back(std::move(tour[i]));
  tour = std::move(stops);
}

// The first clusters of the robot's tour, the viewpoints from which it sees them one by one, and what else it
// sees from there.
TourPlanning::NextStops TourPlanning::next_stops(const Query& query) const {
  const Member& member = members_[query.robot];
  NextStops next;
  const std::size_t count = std::min(options_.joined, member.tour.size());
  for (std::size_t c = 0; c < count; ++c) {
    next.clusters.push_back(&clusters_.cluster(member.tour[c].clusters.front()));
    next.views.sizes.push_back(static_cast<double>(next.clusters.back()->keys.size()));
    for (const ClusterViewpoint& viewpoint : member.sights.viewpoints(next.clusters.back()->id))
      if (const double distance = own_distance_to(query, viewpoint.cell); distance != TourProblem::kNever) {
        next.viewpoints.push_back(viewpoint);
        next.distances.push_back(distance);
        next.views.found_for.push_back(c);
      }
  }
  next.views.parts =
      parts_seen(sight_of(query.robot, query.caster, query.grid), next.viewpoints, next.clusters);
  next.stops = options_.without == TourPart::kJoining ? single_stops(next.views) : join_clusters(next.views);
  return next;
}

double TourPlanning::seconds_to_first(const Query& query, const NextStops& next,
                                      std::size_t viewpoint) const {
  return seconds_to(members_[query.robot].robot, query.starts[query.robot], next.viewpoints[viewpoint],
                    next.distances[viewpoint]);
}

// @pre the distances from the first viewpoint are measured
double TourPlanning::seconds_between(const Query& query, const NextStops& next, std::size_t a,
                                     std::size_t b) const {
  const Member& member = members_[query.robot];
  double distance = member.distances.between(next.viewpoints[a].cell, next.viewpoints[b].cell);
  if (distance == TourProblem::kNever)
    distance = next.distances[a] + next.distances[b];  // by where the robot is
  const Eigen::Vector3d offset =
      lattice_.exact_center(next.viewpoints[b].cell) - lattice_.exact_center(next.viewpoints[a].cell);
  return travel_seconds(member.robot, distance, offset,
                        turn_between(next.viewpoints[a].yaw, next.viewpoints[b].yaw));
}

// The stops in the order in which the robot gets to the clusters soon, each from its first viewpoint.
void TourPlanning::put_in_order(const Query& query, NextStops& next) {
  const std::size_t count = next.stops.size();
  const auto first_of = [&](std::size_t stop) { return next.stops[stop].viewpoints.front(); };
  TourProblem::Robot robot{{}, NumberTable(count, count)};
  std::vector<double> weights;
  std::vector<std::uint32_t> order;
  std::vector<VoxelKey> cells;
  for (std::size_t s = 0; s < count; ++s) {
    robot.first.push_back(seconds_to_first(query, next, first_of(s)));
    weights.push_back(static_cast<double>(next.stops[s].clusters.size()));
    order.push_back(static_cast<std::uint32_t>(s));
    if (s + 1 < count) cells.push_back(next.viewpoints[first_of(s)].cell);
  }
  members_[query.robot].distances.measure_from(cells);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j)
      robot.between(i, j) = robot.between(j, i) = seconds_between(query, next, first_of(i), first_of(j));
  std::vector<JoinedStop> ordered;
  for (const std::uint32_t s : order_by_arrival(robot, weights, std::move(order)))
    ordered.push_back(std::move(next.stops[s]));
  next.stops = std::move(ordered);
}

// The viewpoint of each stop: of the first few those between which the paths are shortest.
std::vector<std::size_t> TourPlanning::chosen_viewpoints(const Query& query, const NextStops& next) {
  std::vector<VoxelKey> cells;
  std::vector<std::vector<std::size_t>> stages;
  const std::size_t refined = options_.without == TourPart::kRefinement ? 0 : options_.refined;
  for (std::size_t s = 0; s < std::min(refined, next.stops.size()); ++s) {
    if (s > 0)  // nothing is measured from the last ones
      for (const std::size_t v : stages.back()) cells.push_back(next.viewpoints[v].cell);
    stages.push_back(next.stops[s].viewpoints);
  }
  members_[query.robot].distances.measure_from(cells);
  std::vector<std::size_t> chosen = shortest_choice(
      stages, [&](std::size_t v) { return seconds_to_first(query, next, v); },
      [&](std::size_t a, std::size_t b) { return seconds_between(query, next, a, b); });
  for (std::size_t s = chosen.size(); s < next.stops.size(); ++s)
    chosen.push_back(next.stops[s].viewpoints.front());
  return chosen;
}

TourStop TourPlanning::stop_at(const Query& query, const NextStops& next, const JoinedStop& joined,
                               std::size_t viewpoint) const {
  const ClusterViewpoint& at = next.viewpoints[viewpoint];
  TourStop stop{{}, {query.corridor.place_in(at.cell), at.yaw}, at.cell, 0};
  double seen = 0.0;
  for (const std::size_t c : joined.clusters) {
    stop.clusters.push_back(next.clusters[c]->id);
    seen += next.views.found_for[viewpoint] == c ? static_cast<double>(at.seen)
                                                 : next.views.parts(viewpoint, c) * next.views.sizes[c];
  }
  stop.seen = static_cast<std::size_t>(seen);
  return stop;
}

// Looks at the clusters of the robot's tour that are nearest from as few places as see them. Their order, and
// the viewpoints of the next few, are those of the shortest paths.
void TourPlanning::join_next_stops(const Query& query) {
  put_nearest_first(query);
  Member& member = members_[query.robot];
  NextStops next = next_stops(query);
  if (options_.without != TourPart::kArrival) put_in_order(query, next);
  const std::vector<std::size_t> chosen = chosen_viewpoints(query, next);
  std::vector<TourStop> tour;
  for (std::size_t s = 0; s < next.stops.size(); ++s)
    tour.push_back(stop_at(query, next, next.stops[s], chosen[s]));
  tour.insert(tour.end(), member.tour.begin() + static_cast<std::ptrdiff_t>(next.clusters.size()),
              member.tour.end());
  member.tour = std::move(tour);
}

}  // namespace frontlux::planner::detail
