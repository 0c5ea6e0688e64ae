// The stops that come next in a robot's tour.

#include "tour/joined_stops.hpp"
#include "tour/shortest_choice.hpp"
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

// Looks at the clusters of the robot's tour that are nearest from as few places as see them. Their order, and
// the viewpoints of the next few, are those of the shortest ways.
void TourPlanning::join_next_stops(const Query& query) {
  put_nearest_first(query);
  Member& member = members_[query.robot];
  const MotionState& start = query.starts[query.robot];
  const std::size_t count = std::min(options_.joined, member.tour.size());
  std::vector<const FrontierCluster*> clusters;
  std::vector<ClusterViewpoint> viewpoints;
  std::vector<double> distances;  // [m] to the viewpoints
  SharedViews views;
  for (std::size_t c = 0; c < count; ++c) {
    clusters.push_back(&cluster(member.tour[c].clusters.front()));
    views.sizes.push_back(static_cast<double>(clusters.back()->keys.size()));
    for (const ClusterViewpoint& viewpoint : member.sights.viewpoints(clusters.back()->id))
      if (const double distance = own_distance_to(query, viewpoint.cell); distance != TourProblem::kNever) {
        viewpoints.push_back(viewpoint);
        distances.push_back(distance);
        views.found_for.push_back(c);
      }
  }
  views.parts = parts_seen(sight_of(query.robot, query.caster), viewpoints, clusters);
  const std::vector<JoinedStop> joined = join_clusters(views);
  const auto first = [&](std::size_t v) {
    return seconds_to(member.robot, start, viewpoints[v], distances[v]);
  };
  const auto between = [&](std::size_t a, std::size_t b) {  // the first one has been measured from
    double way = member.ways.between(viewpoints[a].cell, viewpoints[b].cell);
    if (way == TourProblem::kNever) way = distances[a] + distances[b];  // by where the robot is
    return travel_seconds(member.robot, way, turn_between(viewpoints[a].yaw, viewpoints[b].yaw));
  };

  TourProblem::Robot robot{{}, NumberTable(joined.size(), joined.size())};
  std::vector<double> weights;
  std::vector<std::uint32_t> order;
  std::vector<VoxelKey> cells;
  for (const JoinedStop& stop : joined) {
    robot.first.push_back(first(stop.viewpoints.front()));
    weights.push_back(static_cast<double>(stop.clusters.size()));
    order.push_back(static_cast<std::uint32_t>(order.size()));
    cells.push_back(viewpoints[stop.viewpoints.front()].cell);
  }
  member.ways.measure_from(cells);
  for (std::size_t i = 0; i < joined.size(); ++i)
    for (std::size_t j = i + 1; j < joined.size(); ++j)
      robot.between(i, j) = robot.between(j, i) =
          between(joined[i].viewpoints.front(), joined[j].viewpoints.front());
  order = soonest_order(robot, weights, std::move(order));

  std::vector<std::vector<std::size_t>> stages;
  for (std::size_t s = 0; s < std::min(options_.refined, order.size()); ++s) {
    stages.push_back(joined[order[s]].viewpoints);
    for (const std::size_t v : stages.back()) cells.push_back(viewpoints[v].cell);
  }
  member.ways.measure_from(cells);
  const std::vector<std::size_t> choice = shortest_choice(stages, first, between);
  std::vector<TourStop> tour;
  for (std::size_t s = 0; s < order.size(); ++s) {
    const JoinedStop& stop = joined[order[s]];
    const std::size_t v = s < choice.size() ? choice[s] : stop.viewpoints.front();
    const ClusterViewpoint& viewpoint = viewpoints[v];
    TourStop next{{}, {lattice_.exact_center(viewpoint.cell), viewpoint.yaw}, viewpoint.cell, 0};
    double seen = 0.0;
    for (const std::size_t c : stop.clusters) {
      next.clusters.push_back(clusters[c]->id);
      seen +=
          views.found_for[v] == c ? static_cast<double>(viewpoint.seen) : views.parts(v, c) * views.sizes[c];
    }
    next.seen = static_cast<std::size_t>(seen);
    tour.push_back(std::move(next));
  }
  tour.insert(tour.end(), member.tour.begin() + static_cast<std::ptrdiff_t>(count), member.tour.end());
  member.tour = std::move(tour);
}

}  // namespace frontlux::planner::detail
