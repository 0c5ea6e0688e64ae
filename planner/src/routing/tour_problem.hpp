#pragma once

#include "routing/number_table.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace frontlux::planner::detail {

/// Stops to be shared out to robots, each of which begins where it is and need not come back.
struct TourProblem {
  /// [s] or [m] where there is no path.
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// One robot's travel times [s]; `kNever` for stops that are not for it.
  struct Robot {
    std::vector<double> first;  ///< from where it is to each stop
    NumberTable between;        ///< from stop to stop; the same in both directions
    std::size_t fixed = 0;      ///< so many stops at the begin of its tour stay there
    bool rests = false;  ///< it had no stop when it planned last: those that it has were left to it since
  };
  std::size_t stops = 0;
  std::vector<Robot> robots;
};

/// So many stops a search moves together at most, and so many rounds of changes it makes.
inline constexpr std::size_t kMostMoved = 3, kMostRounds = 200;

/// Stops in order.
using Tour = std::vector<std::uint32_t>;
/// One of each robot.
using Tours = std::vector<Tour>;

}  // namespace frontlux::planner::detail
