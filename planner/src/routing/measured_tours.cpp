#include "routing/measured_tours.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr double kOfAll = 0.1;  // of the sum of all tours, beside the longest

}  // namespace

MeasuredTours::MeasuredTours(const TourProblem& of, Tours given) : problem(of), tours(std::move(given)) {
  tours.resize(problem.robots.size());
  steps.resize(tours.size());
  lengths.resize(tours.size());
  for (std::size_t r = 0; r < tours.size(); ++r) measure(r);
}

void MeasuredTours::measure(std::size_t r) {
  const Tour& tour = tours[r];
  const TourProblem::Robot& robot = problem.robots[r];
  steps[r].resize(tour.size());
  for (std::size_t i = 0; i < tour.size(); ++i)
    steps[r][i] = i == 0 ? robot.first[tour[0]] : robot.between(tour[i - 1], tour[i]);
  lengths[r] = std::accumulate(steps[r].begin(), steps[r].end(), 0.0);
}

double MeasuredTours::cost() const {
  if (lengths.empty()) return 0.0;
  return *std::ranges::max_element(lengths) + kOfAll * std::accumulate(lengths.begin(), lengths.end(), 0.0);
}

double MeasuredTours::cost_with(std::size_t a, double length_a, std::size_t b, double length_b) const {
  double longest = 0.0, sum = 0.0;
  for (std::size_t r = 0; r < lengths.size(); ++r) {
    const double length = r == a ? length_a : r == b ? length_b : lengths[r];
    longest = std::max(longest, length);
    sum += length;
  }
  return longest + kOfAll * sum;
}

std::size_t MeasuredTours::first_free_place(std::size_t r) const {
  return std::min(problem.robots[r].fixed, tours[r].size());
}

double MeasuredTours::detour(std::size_t r, const Tour& tour, const Steps& its_steps, std::size_t at,
                             std::uint32_t first, std::uint32_t last) const {
  const TourProblem::Robot& robot = problem.robots[r];
  const double to = at == 0 ? robot.first[first] : robot.between(first, tour[at - 1]);
  if (at == tour.size()) return to;
  return to + robot.between(last, tour[at]) - its_steps[at];
}

std::vector<std::uint32_t> MeasuredTours::stops_after(std::size_t r) const {
  std::vector<std::uint32_t> after(problem.stops + 1, kNoStop);
  std::size_t before = problem.stops;
  for (const std::uint32_t stop : tours[r]) before = after[before] = stop;
  after[before] = kEndOfTour;
  return after;
}

}  // namespace frontlux::planner::detail
