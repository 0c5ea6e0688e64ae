#pragma once

#include "tour/number_table.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace frontlux::planner::detail {

/// Stops to be shared out to robots, each of which begins where it is and need not come back.
struct TourProblem {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// One robot's travel times [s]; `kNever` for stops that are not for it.
  struct Robot {
    std::vector<double> first;  ///< from where it is to each stop
    NumberTable between;        ///< from stop to stop; the same in both directions
    std::size_t fixed = 0;      ///< so many stops at the begin of its tour stay there
  };
  std::size_t stops = 0;
  std::vector<Robot> robots;

  [[nodiscard]] double length(std::size_t robot, const std::vector<std::uint32_t>& tour) const;
};

/// The stops of each robot, in order.
using Tours = std::vector<std::vector<std::uint32_t>>;

/// Puts stops that are in no tour where they cost least, and shortens the tours by moving stops and turning
/// stretches round until no such change helps: the longest tour first, then all together. Stops that no robot
/// can get to stay out.
[[nodiscard]] Tours shortened_tours(const TourProblem& problem, Tours tours);

/// What `shortened_tours` makes smaller [s].
[[nodiscard]] double cost_of(const TourProblem& problem, const Tours& tours);

}  // namespace frontlux::planner::detail
