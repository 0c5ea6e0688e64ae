#pragma once

#include "routing/tour_problem.hpp"

#include <cstddef>

namespace frontlux::planner::detail {

/// A robot without a stop takes one from another's tour: the nearest one where it is 5 s sooner than the
/// other one, and in half of the time. It leaves what the other one has set out for. The shortest tours would
/// rather let it rest beside a stop that another robot passes much later.
///
/// Of a robot that rests it takes any stop: each knows its own path exactly and the others' about, so that
/// each may find the other one to be nearer, and leave the stop to it for ever.
void give_idle_robot_a_stop(const TourProblem& problem, std::size_t robot, Tours& tours);

}  // namespace frontlux::planner::detail
