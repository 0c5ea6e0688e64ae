#pragma once

#include "routing/tour_problem.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// One robot's stops in an order in which it gets to them soon: by the length of the tour and the mean time
/// of arrival. Of two tours of the same length the one with much to see at its begin is better, since what a
/// robot plans to do later rarely comes to pass; small stops between are not left behind.
/// @param weights  of the stops in the mean
/// @param order    to begin with, and to improve
[[nodiscard]] std::vector<std::uint32_t> order_by_arrival(const TourProblem::Robot& robot,
                                                          std::span<const double> weights,
                                                          std::vector<std::uint32_t> order);

/// What `order_by_arrival` makes smaller [s].
[[nodiscard]] double cost_of_order(const TourProblem::Robot& robot, std::span<const double> weights,
                                   std::span<const std::uint32_t> order);

}  // namespace frontlux::planner::detail
