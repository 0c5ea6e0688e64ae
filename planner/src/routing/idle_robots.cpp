#include "routing/idle_robots.hpp"

#include <cstddef>

namespace frontlux::planner::detail {
namespace {

constexpr double kSooner = 5.0;  // [s] that it gets there before the other one, at least

// Of a stop in another robot's tour.
struct Place {
  double seconds = TourProblem::kNever;  // to get there
  std::size_t tour = 0, at = 0;
};

Place nearest_stop_that_waits(const TourProblem& problem, const Tours& tours, std::size_t idle) {
  Place nearest;
  for (std::size_t r = 0; r < tours.size(); ++r) {
    const TourProblem::Robot& other = problem.robots[r];
    double arrival = 0.0;
    for (std::size_t i = 0; i < tours[r].size(); ++i) {
      const std::uint32_t stop = tours[r][i];
      arrival += i == 0 ? other.first[stop] : other.between(tours[r][i - 1], stop);
      const double seconds = problem.robots[idle].first[stop];
      if (seconds >= nearest.seconds) continue;
      const bool waits = i > 0 && i >= other.fixed && 2 * seconds <= arrival && seconds + kSooner <= arrival;
      if (other.rests || waits) nearest = {seconds, r, i};
    }
  }
  return nearest;
}

}  // namespace

void give_idle_robot_a_stop(const TourProblem& problem, std::size_t robot, Tours& tours) {
  if (!tours[robot].empty()) return;
  const auto [seconds, tour, at] = nearest_stop_that_waits(problem, tours, robot);
  if (seconds == TourProblem::kNever) return;
  const auto stop = tours[tour].begin() + static_cast<std::ptrdiff_t>(at);
  tours[robot].push_back(*stop);
  tours[tour].erase(stop);
}

}  // namespace frontlux::planner::detail
