#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// One place of each stage, so that the path from the start through one after the other costs least.
/// @param first    cost of the path from the start to a place of the first stage
/// @param between  cost of the path from a place of one stage to one of the next; infinite if there is none
template <class First, class Between>
std::vector<std::size_t> shortest_choice(std::span<const std::vector<std::size_t>> stages, const First& first,
                                         const Between& between) {
  struct Best {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t before = 0;
  };
  std::vector<std::vector<Best>> best;  // path to each place
  for (std::size_t s = 0; s < stages.size(); ++s) {
    best.emplace_back(stages[s].size());
    for (std::size_t i = 0; i < stages[s].size(); ++i) {
      Best& to = best[s][i];
      if (s == 0) to.cost = first(stages[s][i]);
      for (std::size_t b = 0; s > 0 && b < stages[s - 1].size(); ++b) {
        const double cost = best[s - 1][b].cost + between(stages[s - 1][b], stages[s][i]);
        if (cost < to.cost) to = {cost, b};
      }
    }
  }
  std::vector<std::size_t> choice(stages.size());
  if (stages.empty()) return choice;
  auto at =
      static_cast<std::size_t>(std::ranges::min_element(best.back(), {}, &Best::cost) - best.back().begin());
  for (std::size_t s = stages.size(); s-- > 0; at = best[s][at].before) choice[s] = stages[s][at];
  return choice;
}

}  // namespace frontlux::planner::detail
