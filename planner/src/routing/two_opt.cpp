#include "routing/two_opt.hpp"

#include <algorithm>

namespace frontlux::planner::detail {

// For each place of a tour, and for its end, whether the step to it is not one of the same direction in the
// tour that was last found to have no stretch worth reversing.
std::vector<std::uint8_t> TwoOpt::new_steps(std::size_t r) const {
  const Tour& tour = tours_.tours[r];
  const std::vector<std::uint32_t>& searched = searched_[r];
  std::vector<std::uint8_t> is_new(tour.size() + 1);
  for (std::size_t i = 0; i <= tour.size(); ++i)
    is_new[i] = searched.empty() || searched[i == 0 ? tours_.problem.stops : tour[i - 1]] !=
                                        (i == tour.size() ? kEndOfTour : tour[i]);
  return is_new;
}

// A stretch in the opposite order changes two steps: of two that were there before it is known not to be
// worth it.
bool TwoOpt::reverse_stretches_of(std::size_t r) {
  Tour& tour = tours_.tours[r];
  const TourProblem::Robot& robot = tours_.problem.robots[r];
  const MeasuredTours::Steps& steps = tours_.steps[r];
  const std::vector<std::uint8_t> is_new = new_steps(r);
  bool reversed = false;
  for (std::size_t i = robot.fixed; i + 1 < tour.size(); ++i)
    for (std::size_t j = i + 1; j < tour.size(); ++j) {
      if (!reversed && is_new[i] == 0 && is_new[j + 1] == 0) continue;
      const double before = steps[i] + (j + 1 < tour.size() ? steps[j + 1] : 0.0);
      const double to = i == 0 ? robot.first[tour[j]] : robot.between(tour[i - 1], tour[j]);
      const double after = to + (j + 1 < tour.size() ? robot.between(tour[i], tour[j + 1]) : 0.0);
      if (after >= before - kCostRounding) continue;
      std::reverse(tour.begin() + static_cast<std::ptrdiff_t>(i),
                   tour.begin() + static_cast<std::ptrdiff_t>(j + 1));
      tours_.measure(r);
      reversed = true;
    }
  searched_[r].clear();
  if (!reversed) searched_[r] = tours_.stops_after(r);
  return reversed;
}

bool TwoOpt::reverse_stretches() {
  bool any = false;
  for (std::size_t r = 0; r < tours_.tours.size(); ++r) any = reverse_stretches_of(r) || any;
  return any;
}

}  // namespace frontlux::planner::detail
