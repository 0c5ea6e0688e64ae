#pragma once

#include "routing/number_table.hpp"

#include <span>

namespace frontlux::planner::detail {

/// Distances that are not known are as short as those by one other place, or by where the robot is. They are
/// the same in both directions.
/// @param distances   [m] from each place to those before it; `TourProblem::kNever`: not known. Then all.
/// @param from_robot  [m] to each place
void complete_distances(NumberTable& distances, std::span<const double> from_robot);

}  // namespace frontlux::planner::detail
