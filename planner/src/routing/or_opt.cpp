#include "routing/or_opt.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// [s] from the first to the last stop of a stretch; `kNever` if it is not for the robot.
double time_within(const TourProblem::Robot& robot, std::span<const std::uint32_t> stretch) {
  if (robot.first[stretch.front()] == TourProblem::kNever) return TourProblem::kNever;
  double time = 0.0;
  for (std::size_t i = 1; i < stretch.size(); ++i) time += robot.between(stretch[i - 1], stretch[i]);
  return time;
}

}  // namespace

OrOpt::OrOpt(MeasuredTours& tours)
    : tours_(tours),
      after_(tours.tours.size()),
      new_links_(tours.tours.size()),
      detours_(tours.tours.size(), std::vector<LeastDetour>(kMostMoved * tours.problem.stops)) {}

OrOpt::Rest OrOpt::rest_of(const Move& move) const {
  const Tour& tour = tours_.tours[move.from];
  const MeasuredTours::Steps& steps = tours_.steps[move.from];
  const TourProblem::Robot& robot = tours_.problem.robots[move.from];
  Rest rest{0.0, tours_.lengths[move.from] - steps[move.begin] - time_within(robot, stretch_of(move))};
  if (move.end() == tour.size()) return rest;
  const std::uint32_t next = tour[move.end()];
  rest.step = move.begin == 0 ? robot.first[next] : robot.between(tour[move.begin - 1], next);
  rest.length -= steps[move.end()];
  rest.length += rest.step;
  return rest;
}

bool OrOpt::is_link(std::size_t r, const Link& link) const {
  return link.a != kNoStop && (after_[r][link.a] == link.b || after_[r][link.b] == link.a);
}

// Those between stops of the tours, and which of them are new since the last time.
void OrOpt::note_links() {
  ++links_noted_;
  for (std::size_t r = 0; r < tours_.tours.size(); ++r) {
    const std::vector<std::uint32_t> before = std::exchange(after_[r], tours_.stops_after(r));
    const Tour& tour = tours_.tours[r];
    new_links_[r].clear();
    for (std::size_t at = std::max<std::size_t>(tours_.first_free_place(r), 1); at < tour.size(); ++at)
      if (before.empty() || (before[tour[at - 1]] != tour[at] && before[tour[at]] != tour[at - 1]))
        new_links_[r].push_back({tour[at - 1], tour[at]});
  }
}

// By the links before the places `begin` to `end` - 1.
void OrOpt::find_least_detour(std::size_t r, std::span<const std::uint32_t> stretch, std::size_t begin,
                              std::size_t end, LeastDetour& least) const {
  const double* from_first = tours_.problem.robots[r].between.row(stretch.front());
  const double* from_last = tours_.problem.robots[r].between.row(stretch.back());
  const std::uint32_t* tour = tours_.tours[r].data();
  const double* steps = tours_.steps[r].data();
  double best = least.added;
  for (std::size_t at = begin; at < end; ++at) {
    const std::uint32_t before = tour[at - 1], after = tour[at];
    best = std::min(best, from_first[before] + from_last[after] - steps[at]);
    best = std::min(best, from_last[before] + from_first[after] - steps[at]);
  }
  if (best == least.added) return;
  while (from_first[tour[begin - 1]] + from_last[tour[begin]] - steps[begin] != best &&
         from_last[tour[begin - 1]] + from_first[tour[begin]] - steps[begin] != best)
    ++begin;
  least.added = best;
  least.in = {tour[begin - 1], tour[begin]};
}

double OrOpt::least_inner_detour(const Move& move) {
  const std::span stretch = stretch_of(move);
  const auto is_in_stretch = [&](std::uint32_t stop) {
    return std::ranges::find(stretch, stop) != stretch.end();
  };
  LeastDetour& least = detours_[move.to][(move.count - 1) * tours_.problem.stops + stretch.front()];
  const std::size_t found = std::exchange(least.found, links_noted_);
  if (found + 1 == links_noted_ && is_link(move.to, least.in) &&
      std::ranges::equal(stretch, std::span(least.stretch).first(move.count))) {
    const NumberTable& between = tours_.problem.robots[move.to].between;
    const double *from_first = between.row(stretch.front()), *from_last = between.row(stretch.back());
    for (const Link& link : new_links_[move.to]) {
      if (is_in_stretch(link.a) || is_in_stretch(link.b)) continue;
      for (const auto& [one, other] : {std::pair(link.a, link.b), std::pair(link.b, link.a)})
        if (const double added = from_first[one] + from_last[other] - between(link.a, link.b);
            added < least.added) {
          least.added = added;
          least.in = link;
        }
    }
    return least.added;
  }
  least = {.found = links_noted_};
  std::ranges::copy(stretch, least.stretch.begin());
  const std::size_t inner = std::max<std::size_t>(tours_.first_free_place(move.to), 1),
                    size = tours_.tours[move.to].size();
  if (move.to != move.from) {
    find_least_detour(move.to, stretch, inner, size, least);
  } else {
    find_least_detour(move.to, stretch, inner, move.begin, least);
    find_least_detour(move.to, stretch, move.end() + 1, size, least);
  }
  return least.added;
}

// What a robot needs more at least, wherever in its tour it takes in the stretch of a move.
double OrOpt::least_detour(const Move& move, double step_of_rest) {
  const std::span stretch = stretch_of(move);
  const Tour& tour = tours_.tours[move.to];
  double least = TourProblem::kNever;
  const auto try_both_directions = [&](const auto& added) {
    least = std::min({least, added(stretch.front(), stretch.back()), added(stretch.back(), stretch.front())});
  };
  const auto try_place = [&](std::size_t at) {
    try_both_directions([&](std::uint32_t first, std::uint32_t last) {
      return tours_.detour(move.to, tour, tours_.steps[move.to], at, first, last);
    });
  };
  const bool from_start = tours_.first_free_place(move.to) == 0;
  least = least_inner_detour(move);
  if (move.to != move.from) {
    if (from_start) try_place(0);
    try_place(tour.size());
    return least;
  }
  if (from_start && move.begin > 0) try_place(0);
  if (move.end() < tour.size()) try_place(tour.size());
  try_both_directions([&](std::uint32_t first, std::uint32_t last) {  // where it was
    const TourProblem::Robot& robot = tours_.problem.robots[move.to];
    const double to = move.begin == 0 ? robot.first[first] : robot.between(first, tour[move.begin - 1]);
    return move.end() == tour.size() ? to : to + robot.between(last, tour[move.end()]) - step_of_rest;
  });
  return least;
}

double OrOpt::cost_of_move(const Move& move, const Rest& rest, double added) const {
  return move.to == move.from
             ? tours_.cost_with(move.from, rest.length + added, move.from, rest.length + added)
             : tours_.cost_with(move.from, rest.length, move.to, tours_.lengths[move.to] + added);
}

// The best move of a stretch that begins at a stop, but for the place in the tour where it leads.
OrOpt::Move OrOpt::best_move_from(std::size_t from, std::size_t begin) {
  Move best;
  for (std::size_t count = 1; count <= kMostMoved && begin + count <= tours_.tours[from].size(); ++count) {
    Move move{.from = from, .begin = begin, .count = count};
    const Rest rest = rest_of(move);
    for (move.to = 0; move.to < tours_.tours.size(); ++move.to) {
      const double within = time_within(tours_.problem.robots[move.to], stretch_of(move));
      if (within == TourProblem::kNever) continue;
      move.cost = cost_of_move(move, rest, within + least_detour(move, rest.step));
      if (move.cost < best.cost) best = move;
    }
  }
  return best;
}

// The first place where the move costs least: what adds more may cost the same, after rounding.
void OrOpt::find_place(Move& move) const {
  const Rest rest = rest_of(move);
  const std::span stretch = stretch_of(move);
  const double within = time_within(tours_.problem.robots[move.to], stretch);
  Tour into = tours_.tours[move.to];
  MeasuredTours::Steps steps = tours_.steps[move.to];
  if (move.to == move.from) {
    const auto remove = [&](auto& numbers) {
      numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(move.begin),
                    numbers.begin() + static_cast<std::ptrdiff_t>(move.end()));
    };
    remove(into);
    remove(steps);
    if (move.begin < into.size()) steps[move.begin] = rest.step;
  }
  Move best;
  for (move.at = std::min(tours_.problem.robots[move.to].fixed, into.size()); move.at <= into.size();
       ++move.at)
    for (const bool reversed : {false, true}) {
      move.reversed = reversed;
      const std::uint32_t first = reversed ? stretch.back() : stretch.front();
      const std::uint32_t last = reversed ? stretch.front() : stretch.back();
      const double added = within + tours_.detour(move.to, into, steps, move.at, first, last);
      move.cost = cost_of_move(move, rest, added);
      if (move.cost < best.cost) best = move;
    }
  move = best;
}

bool OrOpt::move_stops() {
  note_links();
  std::vector<Move> moves;  // the best from each stop
  for (std::size_t from = 0; from < tours_.tours.size(); ++from)
    for (std::size_t begin = tours_.problem.robots[from].fixed; begin < tours_.tours[from].size(); ++begin)
      moves.push_back({.from = from, .begin = begin});
  for_each_index(moves.size(),
                 [&](std::size_t i) { moves[i] = best_move_from(moves[i].from, moves[i].begin); });
  const auto best = std::ranges::min_element(moves, {}, &Move::cost);
  if (best == moves.end() || !(best->cost < tours_.cost() - kCostRounding)) return false;
  find_place(*best);
  make(*best);
  return true;
}

void OrOpt::make(const Move& move) {
  Tour& tour = tours_.tours[move.from];
  const auto begin = tour.begin() + static_cast<std::ptrdiff_t>(move.begin);
  Tour stretch(begin, begin + static_cast<std::ptrdiff_t>(move.count));
  if (move.reversed) std::ranges::reverse(stretch);
  tour.erase(begin, begin + static_cast<std::ptrdiff_t>(move.count));
  Tour& into = tours_.tours[move.to];
  into.insert(into.begin() + static_cast<std::ptrdiff_t>(move.at), stretch.begin(), stretch.end());
  for (const std::size_t r : {move.from, move.to}) tours_.measure(r);
}

}  // namespace frontlux::planner::detail
