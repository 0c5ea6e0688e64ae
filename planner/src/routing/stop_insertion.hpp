#pragma once

#include "routing/measured_tours.hpp"

namespace frontlux::planner::detail {

/// Puts the stops that are in no tour where they cost least, each time the cheapest one. Stops that no robot
/// can get to stay out.
void insert_missing_stops(MeasuredTours& tours);

}  // namespace frontlux::planner::detail
