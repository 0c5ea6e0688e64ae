#pragma once

#include "routing/number_table.hpp"

#include <span>

namespace frontlux::planner::detail {

/// Fills in the distances that are not known: the shortest path by one other place, or by where the robot is.
/// @param distances   [m] from each place to those before it, `TourProblem::kNever` where it is not known;
///                    afterwards from each place to all others, the same in both directions
/// @param from_robot  [m] to each place
void complete_distances(NumberTable& distances, std::span<const double> from_robot);

}  // namespace frontlux::planner::detail
