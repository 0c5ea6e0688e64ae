#include "routing/tour_search.hpp"

#include "routing/measured_tours.hpp"
#include "routing/or_opt.hpp"
#include "routing/stop_insertion.hpp"
#include "routing/two_opt.hpp"

#include <cstddef>
#include <utility>

namespace frontlux::planner::detail {

Tours shortened_tours(const TourProblem& problem, Tours tours) {
  MeasuredTours measured(problem, std::move(tours));
  insert_missing_stops(measured);
  TwoOpt two_opt(measured);
  OrOpt or_opt(measured);
  for (std::size_t round = 0; round < kMostRounds; ++round)
    if (!two_opt.reverse_stretches() && !or_opt.move_stops()) break;
  return std::move(measured.tours);
}

double cost_of(const TourProblem& problem, const Tours& tours) {
  return MeasuredTours(problem, tours).cost();
}

}  // namespace frontlux::planner::detail
