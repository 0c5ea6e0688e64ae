// What stops there are, and how long robots take to them and from one to another: the problem of the tours.

#include "routing/complete_distances.hpp"
#include "tour/tour_planning.hpp"
#include "tour/travel_seconds.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <set>
#include <utility>

namespace frontlux::planner::detail {

// Those that some robot sees.
std::vector<SeenCluster> TourPlanning::seen_clusters(std::span<const MotionState> starts) const {
  std::set<ClusterId> first;  // to which a robot is going
  for (const Member& member : members_) first.insert(member.going_for.begin(), member.going_for.end());
  std::vector<SeenCluster> seen;
  const auto clusters = clusters_.clusters();
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    const KeyBox& box = clusters[i].box;
    const VoxelKey middle =
        make_key((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2, (box.min.z + box.max.z) / 2);
    std::vector<bool> by;
    double nearest = TourProblem::kNever;
    for (std::size_t r = 0; r < members_.size(); ++r) {
      by.push_back(best_viewpoint(members_[r], i) != nullptr);
      const double distance = (lattice_.exact_center(middle) - starts[r].pose.position).norm();
      if (by[r]) nearest = std::min(nearest, distance / (options_.near * members_[r].robot.view.max_range));
    }
    if (nearest != TourProblem::kNever)
      seen.push_back({i, middle, std::move(by), nearest, first.contains(clusters[i].id)});
  }
  return seen;
}

std::vector<StopClusters> TourPlanning::stop_places(const Query& query) const {
  std::vector<SeenCluster> seen = seen_clusters(query.starts);
  if (options_.without != TourPart::kZones) return group_into_stops(seen, zone_edge_);
  std::vector<StopClusters> places;
  for (const SeenCluster& cluster : seen) places.push_back({cluster.cluster});
  return places;
}

// The clusters of a stop, each time the nearest one.
StopClusters TourPlanning::in_order(const Member& member, const StopClusters& stop,
                                    Eigen::Vector3d from) const {
  std::vector<std::pair<std::uint32_t, Eigen::Vector3d>> rest;
  for (const std::uint32_t cluster : stop)
    rest.emplace_back(cluster, lattice_.exact_center(best_viewpoint(member, cluster)->cell));
  StopClusters order;
  while (!rest.empty()) {
    const auto nearest = std::ranges::min_element(
        rest, {}, [&](const auto& cluster) { return (cluster.second - from).norm(); });
    from = nearest->second;
    order.push_back(nearest->first);
    rest.erase(nearest);
  }
  return order;
}

TourProblem::Robot TourPlanning::travel_times(const Query& query, std::size_t r,
                                              std::span<const StopClusters> stops) {
  Member& member = members_[r];
  const MotionState& start = query.starts[r];
  const std::size_t count = stops.size();
  TourProblem::Robot robot{std::vector<double>(count, TourProblem::kNever),
                           NumberTable(count, count, TourProblem::kNever)};
  if (!member.distances.has_start()) return robot;

  std::vector<const ClusterViewpoint*> at(count);
  std::vector<VoxelKey> cells;
  for (std::size_t i = 0; i < count; ++i)
    if ((at[i] = best_viewpoint(member, stops[i].front())) != nullptr) cells.push_back(at[i]->cell);
  member.distances.measure_from(cells);
  std::vector<double> to(count, TourProblem::kNever);  // [m] to each stop
  std::vector<double> within(count);                   // [s] from cluster to cluster of a stop
  for (std::size_t i = 0; i < count; ++i) {
    if (at[i] == nullptr) continue;
    const double distance =
        r == query.robot ? own_distance_to(query, at[i]->cell) : member.distances.from_start(at[i]->cell);
    if (distance == TourProblem::kNever) {
      at[i] = nullptr;
      continue;
    }
    to[i] = distance;
    Eigen::Vector3d before = lattice_.exact_center(at[i]->cell);
    for (const std::uint32_t cluster : in_order(member, stops[i], before)) {
      const Eigen::Vector3d next = lattice_.exact_center(best_viewpoint(member, cluster)->cell);
      within[i] += travel_seconds(member.robot, (next - before).norm(), next - before, 0.0);
      before = next;
    }
    robot.first[i] = seconds_to(member.robot, start, *at[i], distance) + within[i] / 2;
  }
  std::vector<std::optional<VoxelKey>> places(count);
  for (std::size_t i = 0; i < count; ++i)
    if (at[i] != nullptr) places[i] = at[i]->cell;
  NumberTable distances = member.distances.between(places);  // [m]
  complete_distances(distances, to);
  for_each_index(count, [&](std::size_t i) {
    for (std::size_t j = 0; j < count; ++j)
      if (i != j && distances(i, j) != TourProblem::kNever)
        robot.between(i, j) =
            travel_seconds(member.robot, distances(i, j),
                           lattice_.exact_center(at[j]->cell) - lattice_.exact_center(at[i]->cell),
                           turn_between(at[i]->yaw, at[j]->yaw)) +
            (within[i] + within[j]) / 2;
  });
  return robot;
}

TourProblem TourPlanning::problem(const Query& query, std::span<const StopClusters> stops) {
  TourProblem problem;
  problem.stops = stops.size();
  for (std::size_t r = 0; r < members_.size(); ++r) problem.robots.push_back(travel_times(query, r, stops));
  return problem;
}

}  // namespace frontlux::planner::detail
