#pragma once

#include "routing/tour_problem.hpp"

namespace frontlux::planner::detail {

/// Puts stops that are in no tour where they cost least, and shortens the tours by 2-opt and Or-opt until no
/// such change makes `cost_of` smaller. Stops that no robot can get to stay out.
[[nodiscard]] Tours shortened_tours(const TourProblem& problem, Tours tours);

/// What `shortened_tours` makes smaller [s].
[[nodiscard]] double cost_of(const TourProblem& problem, const Tours& tours);

}  // namespace frontlux::planner::detail
