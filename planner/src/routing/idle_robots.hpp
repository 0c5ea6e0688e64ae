#pragma once

#include "routing/tour_problem.hpp"

namespace frontlux::planner::detail {

/// A robot without a stop takes one from another's tour if it gets there in half of the time that the other
/// one will need: the nearest such stop. Where others set out for already, it does not go. The shortest tours
/// would rather let it rest beside a stop that another robot passes much later.
void give_idle_robots_stops(const TourProblem& problem, Tours& tours);

}  // namespace frontlux::planner::detail
