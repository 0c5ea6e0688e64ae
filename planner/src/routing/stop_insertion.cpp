#include "routing/stop_insertion.hpp"

#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {
namespace {

// Of a stop in a tour.
struct Place {
  double added = TourProblem::kNever;  // [s] to the tour
  std::size_t at = 0;
};

double cost_with_more(const MeasuredTours& tours, std::size_t r, double added) {
  const double length = tours.lengths[r] + added;
  return tours.cost_with(r, length, r, length);
}

double detour(const MeasuredTours& tours, std::size_t r, std::uint32_t stop, std::size_t at) {
  return tours.detour(r, tours.tours[r], tours.steps[r], at, stop, stop);
}

void choose_if_cheaper(const MeasuredTours& tours, std::size_t r, std::uint32_t stop, std::size_t at,
                       Place& place) {
  if (at < tours.first_free_place(r) || tours.problem.robots[r].first[stop] == TourProblem::kNever) return;
  if (const double added = detour(tours, r, stop, at); added < place.added) place = {added, at};
}

Place cheapest_place(const MeasuredTours& tours, std::size_t r, std::uint32_t stop) {
  Place place;
  for (std::size_t at = tours.first_free_place(r); at <= tours.tours[r].size(); ++at)
    choose_if_cheaper(tours, r, stop, at, place);
  return place;
}

// Places that add about as much may cost the same, after rounding.
std::size_t first_place_for(const MeasuredTours& tours, std::size_t r, std::uint32_t stop, double cost) {
  std::size_t at = tours.first_free_place(r);
  while (at < tours.tours[r].size() && cost_with_more(tours, r, detour(tours, r, stop, at)) != cost) ++at;
  return at;
}

}  // namespace

void insert_missing_stops(MeasuredTours& tours) {
  const std::size_t stops = tours.problem.stops, robots = tours.tours.size();
  std::vector<bool> has(stops);
  for (const Tour& tour : tours.tours)
    for (const std::uint32_t stop : tour) has[stop] = true;
  std::vector<std::vector<Place>> places;  // of each robot, for each stop
  for (std::size_t r = 0; r < robots; ++r) {
    places.emplace_back(stops);
    for (std::uint32_t stop = 0; stop < stops; ++stop)
      if (!has[stop]) places[r][stop] = cheapest_place(tours, r, stop);
  }
  for (;;) {
    double best = TourProblem::kNever;
    std::size_t r = 0;
    std::uint32_t what = 0;
    for (std::uint32_t stop = 0; stop < stops; ++stop)
      for (std::size_t other = 0; other < robots && !has[stop]; ++other)
        if (const double cost = cost_with_more(tours, other, places[other][stop].added); cost < best) {
          best = cost;
          r = other;
          what = stop;
        }
    if (best == TourProblem::kNever) return;
    has[what] = true;
    Tour& tour = tours.tours[r];
    const std::size_t at = first_place_for(tours, r, what, best);
    tour.insert(tour.begin() + static_cast<std::ptrdiff_t>(at), what);
    tours.measure(r);
    // Only one step of the tour has become another one, or rather two.
    for (std::uint32_t stop = 0; stop < stops; ++stop) {
      if (has[stop]) continue;
      Place& place = places[r][stop];
      if (place.at == at) {
        place = cheapest_place(tours, r, stop);
        continue;
      }
      place.at += place.at > at ? 1 : 0;
      for (const std::size_t next : {at, at + 1}) choose_if_cheaper(tours, r, stop, next, place);
    }
  }
}

}  // namespace frontlux::planner::detail
