#include "routing/order_by_arrival.hpp"

#include "routing/measured_tours.hpp"

#include <algorithm>
#include <cstddef>

namespace frontlux::planner::detail {
namespace {

constexpr double kSoon = 3.0;  // weight of the mean arrival, beside the length

}  // namespace

double cost_of_order(const TourProblem::Robot& robot, std::span<const double> weights,
                     std::span<const std::uint32_t> order) {
  double time = 0.0, sum = 0.0, all = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    time += i == 0 ? robot.first[order[0]] : robot.between(order[i - 1], order[i]);
    sum += weights[order[i]] * time;
    all += weights[order[i]];
  }
  return all > 0.0 ? time + kSoon * sum / all : time;
}

Tour order_by_arrival(const TourProblem::Robot& robot, std::span<const double> weights, Tour order) {
  double cost = cost_of_order(robot, weights, order);
  Tour best, changed;
  const auto consider = [&] {
    const double now = cost_of_order(robot, weights, changed);
    if (now >= cost - kCostRounding) return;
    cost = now;
    best = changed;
  };
  const auto at = [&](std::size_t i) { return changed.begin() + static_cast<std::ptrdiff_t>(i); };
  for (std::size_t round = 0; round < kMostRounds; ++round) {
    best.clear();
    for (std::size_t begin = 0; begin < order.size(); ++begin)
      for (std::size_t end = begin + 1; end <= order.size(); ++end) {
        changed = order;
        std::reverse(at(begin), at(end));
        consider();
        if (end - begin > kMostMoved) continue;
        // Both the stretch and the one turned round, on to each later place and back to each earlier one.
        for (const bool turned : {false, true}) {
          if (turned && end - begin == 1) continue;
          changed = order;
          if (turned) std::reverse(at(begin), at(end));
          for (std::size_t to = end; to < order.size(); ++to) {
            std::rotate(at(begin + to - end), at(to), at(to + 1));
            consider();
          }
          changed = order;
          if (turned) std::reverse(at(begin), at(end));
          for (std::size_t to = begin; to-- > 0;) {
            std::rotate(at(to), at(to + 1), at(to + 1 + end - begin));
            consider();
          }
        }
      }
    if (best.empty()) break;
    order = best;
  }
  return order;
}

}  // namespace frontlux::planner::detail
