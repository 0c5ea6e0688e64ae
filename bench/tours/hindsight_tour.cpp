#include "tours/hindsight_tour.hpp"

#include "routing/measured_tours.hpp"
#include "routing/tour_search.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/lattice.hpp>
#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::bench {
namespace {

using planner::TravelCorridor, planner::TravelOptions;
using planner::detail::MeasuredTours, planner::detail::NumberTable, planner::detail::shortened_tours,
    planner::detail::Tour, planner::detail::TourProblem;

void check(const Lattice& lattice, const KeyBox& bounds, std::span<const Eigen::Vector3d> places) {
  for (const Eigen::Vector3d& place : places)
    if (const auto key = lattice.key(place); !key || !bounds.contains(*key))
      throw std::invalid_argument("hindsight tour: the robot was at (" + std::to_string(place.x()) + ", " +
                                  std::to_string(place.y()) + ", " + std::to_string(place.z()) +
                                  ") m, outside of the bounds");
}

// What a robot has gone through becomes free, and ground that it has gone on carries it: voxels seen later
// may say otherwise, and nobody sees the floor of its start.
void open_path(TravelOptions& travel, VoxelGrid& map, const KeyBox& bounds,
               std::span<const Eigen::Vector3d> path) {
  const Lattice lattice(map.resolution());
  TravelCorridor corridor(travel, lattice, bounds);
  corridor.update({map, {}}, *lattice.key(path.front()));
  std::vector<VoxelKey> closed;
  for (std::size_t i = 0; i < path.size(); ++i)
    static_cast<void>(
        planner::SegmentVoxels(lattice, path[i == 0 ? 0 : i - 1], path[i]).all_of([&](const VoxelKey& voxel) {
          const VoxelKey cell = corridor.cell_of(voxel);
          if (!corridor.passable(cell)) closed.push_back(cell);
          return true;
        }));
  std::sort(closed.begin(), closed.end());
  closed.erase(std::unique(closed.begin(), closed.end()), closed.end());
  const planner::BodyStencil stencil(travel, map.resolution());
  for (const VoxelKey& cell : closed) {
    static_cast<void>(stencil.all_of(cell, [&](const VoxelKey& key) {
      map.set(key, Occupancy::kFree);
      return true;
    }));
    if (travel.drives()) travel.without_ground.push_back({cell, cell});
  }
}

Tour in_order(const TourProblem& problem) {
  Tour tour(problem.stops);
  std::iota(tour.begin(), tour.end(), 0U);
  return tour;
}

// From one stop to the nearest of those left, and so on.
Tour nearest_neighbours(const TourProblem& problem, std::uint32_t first) {
  Tour tour = {first}, left = in_order(problem);
  std::erase(left, first);
  while (!left.empty()) {
    const auto next = std::ranges::min_element(
        left, {}, [&](std::uint32_t stop) { return problem.robots[0].between(tour.back(), stop); });
    tour.push_back(*next);
    left.erase(next);
  }
  return tour;
}

double length(const TourProblem& problem, const Tour& tour) {
  return MeasuredTours(problem, {tour}).lengths.front();
}

// One search makes only so many changes.
Tour shortest_from(const TourProblem& problem, Tour tour) {
  for (double before = TourProblem::kNever; length(problem, tour) < before;) {
    before = length(problem, tour);
    tour = shortened_tours(problem, {std::move(tour)}).front();
  }
  return tour;
}

Tour shortest_tour(const TourProblem& problem) {
  std::vector<Tour> tours = {in_order(problem)};
  for (std::uint32_t first = 0; first < problem.stops; ++first)
    tours.push_back(nearest_neighbours(problem, first));
  for (Tour& tour : tours) tour = shortest_from(problem, std::move(tour));
  return *std::ranges::min_element(tours, {}, [&](const Tour& tour) { return length(problem, tour); });
}

}  // namespace

HindsightTour hindsight_tour(TravelOptions travel, VoxelGrid map, const KeyBox& bounds,
                             std::span<const Eigen::Vector3d> path, std::span<const Eigen::Vector3d> stops) {
  const Lattice lattice(map.resolution());
  if (path.empty()) throw std::invalid_argument("hindsight tour: the path has no start");
  check(lattice, bounds, path);
  check(lattice, bounds, stops);
  open_path(travel, map, bounds, path);
  TravelCorridor corridor(travel, lattice, bounds);
  const auto spread_from = [&](const Eigen::Vector3d& place) {
    corridor.update({map, {}}, *lattice.key(place));
  };
  std::vector<Eigen::Vector3d> places = {path.front()};  // the start, and the stops
  std::vector<VoxelKey> cells = {corridor.cell_of(*lattice.key(path.front()))};
  for (const Eigen::Vector3d& stop : stops) {
    const VoxelKey cell = corridor.cell_of(*lattice.key(stop));
    if (std::ranges::find(cells, cell) != cells.end()) continue;
    cells.push_back(cell);
    places.push_back(stop);
  }
  const auto distance_to = [&](std::size_t i) {
    if (const auto distance = corridor.distance(cells[i])) return *distance;
    throw std::invalid_argument("hindsight tour: the stop at (" + std::to_string(places[i].x()) + ", " +
                                std::to_string(places[i].y()) + ", " + std::to_string(places[i].z()) +
                                ") m is not on the path");
  };

  TourProblem problem;
  problem.stops = cells.size() - 1;
  problem.robots.push_back({std::vector<double>(problem.stops), NumberTable(problem.stops, problem.stops)});
  TourProblem::Robot& robot = problem.robots[0];
  for (std::size_t i = 0; i < cells.size(); ++i) {
    spread_from(places[i]);
    for (std::size_t j = 1; j < cells.size(); ++j)
      (i == 0 ? robot.first[j - 1] : robot.between(i - 1, j - 1)) = distance_to(j);
  }

  const auto length_of = [&](const Tour& tour) {
    double length = 0.0;
    std::size_t from = 0;
    for (const std::uint32_t stop : tour) {
      const std::size_t to = stop + 1;
      spread_from(places[from]);
      double leg = distance_to(to);
      if (travel.node_edge == 0.0) {  // else the corridor's cells are nodes, in which no path is planned
        const auto plan = planner::plan_path(corridor, lattice, {places[from]}, {places[to]}, {},
                                             {.search = planner::PathSearch::kCorridor});
        if (plan.found()) leg = std::min(leg, plan.length);
      }
      length += leg;
      from = to;
    }
    return length;
  };
  Tour tour = in_order(problem);
  const double in_order_length = length_of(tour);
  HindsightTour result{{cells[0]}, in_order_length, in_order_length};
  Tour found = shortest_tour(problem);  // along the corridor's cells, so that its paths may be longer
  if (const double length = length_of(found); length <= in_order_length) {
    result.length = length;
    tour = std::move(found);
  }
  for (const std::uint32_t stop : tour) result.cells.push_back(cells[stop + 1]);
  return result;
}

}  // namespace frontlux::bench
