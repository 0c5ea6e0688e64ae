#include "routing/complete_distances.hpp"

#include "routing/tour_problem.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace frontlux::planner::detail {

void complete_distances(NumberTable& distances, std::span<const double> from_robot) {
  const std::size_t count = from_robot.size();
  const auto mirror = [&] {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = i + 1; j < count; ++j) distances(i, j) = distances(j, i);
  };
  mirror();
  const NumberTable known = distances;
  for_each_index(count, [&](std::size_t i) {
    std::vector<double> by_one(count, TourProblem::kNever);
    // Also where it is known: without a branch the compiler takes several at a time.
    const auto shorten = [&](double to_middle, const double* from_middle) {
      for (std::size_t j = 0; j < i && to_middle != TourProblem::kNever; ++j)
        by_one[j] = std::min(by_one[j], to_middle + from_middle[j]);
    };
    shorten(from_robot[i], from_robot.data());
    for (std::size_t k = 0; k < count; ++k) shorten(known(i, k), known.row(k));
    for (std::size_t j = 0; j < i; ++j)
      if (known(i, j) == TourProblem::kNever) distances(i, j) = by_one[j];
  });
  mirror();
}

}  // namespace frontlux::planner::detail
