#include "tour/tour_search.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

namespace frontlux::planner::detail {
namespace {

using Tour = std::vector<std::uint32_t>;

constexpr double kWorth = 1e-6;       // [s] smaller gains are rounding
constexpr double kOfAll = 0.1;        // of the sum of all tours, beside the longest
constexpr std::size_t kMoved = 3;     // stops moved together, at most
constexpr std::size_t kRounds = 200;  // of changes, at most
constexpr std::uint32_t kNone = ~std::uint32_t{0}, kEnd = kNone - 1;  // instead of a stop

double step(const TourProblem::Robot& robot, const Tour& tour, std::size_t to) {
  return to == 0 ? robot.first[tour[0]] : robot.between(tour[to - 1], tour[to]);
}

// The tours and their lengths.
class Search {
 public:
  Search(const TourProblem& problem, Tours tours) : problem_(problem), tours_(std::move(tours)) {
    tours_.resize(problem.robots.size());
    steps_.resize(tours_.size());
    lengths_.resize(tours_.size());
    turned_.resize(tours_.size());
    after_.resize(tours_.size());
    new_links_.resize(tours_.size());
    for (std::size_t r = 0; r < tours_.size(); ++r) measure(r);
  }

  void insert_missing() {
    std::vector<bool> has(problem_.stops);
    for (const Tour& tour : tours_)
      for (const std::uint32_t stop : tour) has[stop] = true;
    std::vector<std::vector<Place>> places;  // of each robot, for each stop
    for (std::size_t r = 0; r < tours_.size(); ++r) {
      places.emplace_back(problem_.stops);
      for (std::uint32_t stop = 0; stop < problem_.stops; ++stop)
        if (!has[stop]) places[r][stop] = cheapest_place(r, stop);
    }
    for (;;) {
      double best = TourProblem::kNever;
      std::size_t r = 0;
      std::uint32_t what = 0;
      for (std::uint32_t stop = 0; stop < problem_.stops; ++stop)
        for (std::size_t other = 0; other < tours_.size() && !has[stop]; ++other)
          if (const double cost = cost_with_more(other, places[other][stop].added); cost < best) {
            best = cost;
            r = other;
            what = stop;
          }
      if (best == TourProblem::kNever) return;
      has[what] = true;
      Tour& tour = tours_[r];
      const std::size_t at = first_place_for(r, what, best);
      tour.insert(tour.begin() + static_cast<std::ptrdiff_t>(at), what);
      measure(r);
      // Only one step of the tour has become another one, or rather two.
      for (std::uint32_t stop = 0; stop < problem_.stops; ++stop) {
        if (has[stop]) continue;
        Place& place = places[r][stop];
        if (place.at == at) {
          place = cheapest_place(r, stop);
          continue;
        }
        place.at += place.at > at ? 1 : 0;
        for (const std::size_t next : {at, at + 1}) take_if_cheaper(place, r, stop, next);
      }
    }
  }

  void improve() {
    detours_.assign(tours_.size(), std::vector<LeastDetour>(kMoved * problem_.stops));
    for (std::size_t round = 0; round < kRounds; ++round)
      if (!turn_a_stretch() && !move_stops()) return;
  }

  [[nodiscard]] double cost() const { return cost(lengths_); }
  Tours take() { return std::move(tours_); }

 private:
  struct Place {
    double added = TourProblem::kNever;  // [s] to the tour
    std::size_t at = 0;
  };

  static double cost(const std::vector<double>& lengths) {
    if (lengths.empty()) return 0.0;
    return *std::ranges::max_element(lengths) + kOfAll * std::accumulate(lengths.begin(), lengths.end(), 0.0);
  }
  [[nodiscard]] double cost_with(std::size_t a, double length_a, std::size_t b, double length_b) const {
    double longest = 0.0, sum = 0.0;
    for (std::size_t r = 0; r < lengths_.size(); ++r) {
      const double length = r == a ? length_a : r == b ? length_b : lengths_[r];
      longest = std::max(longest, length);
      sum += length;
    }
    return longest + kOfAll * sum;
  }

  [[nodiscard]] double cost_with_more(std::size_t r, double added) const {
    return cost_with(r, lengths_[r] + added, r, lengths_[r] + added);
  }

  // Of a tour: the time to each of its stops from the one before.
  using Steps = std::vector<double>;

  void measure(std::size_t r) {
    const Tour& tour = tours_[r];
    steps_[r].resize(tour.size());
    for (std::size_t i = 0; i < tour.size(); ++i) steps_[r][i] = step(problem_.robots[r], tour, i);
    lengths_[r] = std::accumulate(steps_[r].begin(), steps_[r].end(), 0.0);
  }

  // What a robot needs more to take in a stretch before place `at` of its tour.
  [[nodiscard]] double detour(std::size_t r, const Tour& tour, const Steps& steps, std::size_t at,
                              std::uint32_t first, std::uint32_t last) const {
    const TourProblem::Robot& robot = problem_.robots[r];
    const double to = at == 0 ? robot.first[first] : robot.between(first, tour[at - 1]);
    if (at == tour.size()) return to;
    return to + robot.between(last, tour[at]) - steps[at];
  }

  [[nodiscard]] std::size_t first_free_place(std::size_t r) const {
    return std::min(problem_.robots[r].fixed, tours_[r].size());
  }
  void take_if_cheaper(Place& place, std::size_t r, std::uint32_t stop, std::size_t at) const {
    if (at < first_free_place(r) || problem_.robots[r].first[stop] == TourProblem::kNever) return;
    if (const double added = detour(r, tours_[r], steps_[r], at, stop, stop); added < place.added)
      place = {added, at};
  }
  [[nodiscard]] Place cheapest_place(std::size_t r, std::uint32_t stop) const {
    Place place;
    for (std::size_t at = first_free_place(r); at <= tours_[r].size(); ++at)
      take_if_cheaper(place, r, stop, at);
    return place;
  }
  // Places that add about as much may cost the same, after rounding.
  [[nodiscard]] std::size_t first_place_for(std::size_t r, std::uint32_t stop, double cost) const {
    std::size_t at = first_free_place(r);
    while (at < tours_[r].size() &&
           cost_with_more(r, detour(r, tours_[r], steps_[r], at, stop, stop)) != cost)
      ++at;
    return at;
  }

  // For each place of a tour, and for its end, whether the step to it is not one of the same direction in the
  // tour that was last found to have no stretch worth turning.
  [[nodiscard]] std::vector<std::uint8_t> new_steps(std::size_t r) const {
    const Tour& tour = tours_[r];
    std::vector<std::uint8_t> is_new(tour.size() + 1);
    for (std::size_t i = 0; i <= tour.size(); ++i)
      is_new[i] = turned_[r].empty() ||
                  turned_[r][i == 0 ? problem_.stops : tour[i - 1]] != (i == tour.size() ? kEnd : tour[i]);
    return is_new;
  }

  // 2-opt. Turning a stretch changes two steps: of two that were there before it is known not to be worth it.
  bool turn_a_stretch() {
    bool any = false;
    for (std::size_t r = 0; r < tours_.size(); ++r) {
      Tour& tour = tours_[r];
      const TourProblem::Robot& robot = problem_.robots[r];
      const Steps& steps = steps_[r];
      const std::vector<std::uint8_t> is_new = new_steps(r);
      bool turned = false;
      for (std::size_t i = robot.fixed; i + 1 < tour.size(); ++i)
        for (std::size_t j = i + 1; j < tour.size(); ++j) {
          if (!turned && is_new[i] == 0 && is_new[j + 1] == 0) continue;
          const double before = steps[i] + (j + 1 < tour.size() ? steps[j + 1] : 0.0);
          const double to = i == 0 ? robot.first[tour[j]] : robot.between(tour[i - 1], tour[j]);
          const double after = to + (j + 1 < tour.size() ? robot.between(tour[i], tour[j + 1]) : 0.0);
          if (after >= before - kWorth) continue;
          std::reverse(tour.begin() + static_cast<std::ptrdiff_t>(i),
                       tour.begin() + static_cast<std::ptrdiff_t>(j + 1));
          measure(r);
          any = turned = true;
        }
      turned_[r].clear();
      if (!turned) turned_[r] = stops_after(r);
    }
    return any;
  }

  // The stop that follows each one in a tour, and the start of the tour, which comes last.
  [[nodiscard]] std::vector<std::uint32_t> stops_after(std::size_t r) const {
    std::vector<std::uint32_t> after(problem_.stops + 1, kNone);
    std::size_t before = problem_.stops;
    for (const std::uint32_t stop : tours_[r]) before = after[before] = stop;
    after[before] = kEnd;
    return after;
  }

  struct Move {
    std::size_t from = 0, begin = 0, count = 0, to = 0, at = 0;
    bool turned = false;
    double cost = TourProblem::kNever;  // of all tours afterwards
    [[nodiscard]] std::size_t end() const { return begin + count; }
  };
  [[nodiscard]] std::span<const std::uint32_t> stretch_of(const Move& move) const {
    return std::span(tours_[move.from]).subspan(move.begin, move.count);
  }

  // A tour from which a stretch has been taken out: the step over the gap, and the length.
  struct Rest {
    double step = 0.0, length = 0.0;  // [s]
  };
  [[nodiscard]] Rest rest_of(const Move& move) const {
    const Tour& tour = tours_[move.from];
    const Steps& steps = steps_[move.from];
    const TourProblem::Robot& robot = problem_.robots[move.from];
    Rest rest{0.0, lengths_[move.from] - steps[move.begin] - time_within(robot, stretch_of(move))};
    if (move.end() == tour.size()) return rest;
    const std::uint32_t next = tour[move.end()];
    rest.step = move.begin == 0 ? robot.first[next] : robot.between(tour[move.begin - 1], next);
    rest.length -= steps[move.end()];
    rest.length += rest.step;
    return rest;
  }

  // [s] from the first to the last stop of a stretch; `kNever` if it is not for the robot.
  [[nodiscard]] static double time_within(const TourProblem::Robot& robot,
                                          std::span<const std::uint32_t> stretch) {
    if (robot.first[stretch.front()] == TourProblem::kNever) return TourProblem::kNever;
    double time = 0.0;
    for (std::size_t i = 1; i < stretch.size(); ++i) time += robot.between(stretch[i - 1], stretch[i]);
    return time;
  }

  // A step between two stops of a tour, either of which may come first.
  struct Link {
    std::uint32_t a = kNone, b = kNone;
  };
  // What a robot needs more at least to take in a stretch between two stops of its tour that are not in the
  // stretch. As long as that link is there, only links that are new since then may be better.
  struct LeastDetour {
    std::array<std::uint32_t, kMoved> stretch{};
    double added = TourProblem::kNever;  // [s]
    Link in = {};
    std::size_t found = 0;  // when, by the count of `note_links`
  };

  [[nodiscard]] bool is_link(std::size_t r, const Link& link) const {
    return link.a != kNone && (after_[r][link.a] == link.b || after_[r][link.b] == link.a);
  }
  // Those between stops of the tours, and which of them are new since the last time.
  void note_links() {
    ++links_noted_;
    for (std::size_t r = 0; r < tours_.size(); ++r) {
      const std::vector<std::uint32_t> before = std::exchange(after_[r], stops_after(r));
      const Tour& tour = tours_[r];
      new_links_[r].clear();
      for (std::size_t at = std::max<std::size_t>(first_free_place(r), 1); at < tour.size(); ++at)
        if (before.empty() || (before[tour[at - 1]] != tour[at] && before[tour[at]] != tour[at - 1]))
          new_links_[r].push_back({tour[at - 1], tour[at]});
    }
  }

  // By the links before the places `begin` to `end` - 1.
  void find_least_detour(std::size_t r, std::span<const std::uint32_t> stretch, std::size_t begin,
                         std::size_t end, LeastDetour& least) const {
    const double* from_first = problem_.robots[r].between.row(stretch.front());
    const double* from_last = problem_.robots[r].between.row(stretch.back());
    const std::uint32_t* tour = tours_[r].data();
    const double* steps = steps_[r].data();
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

  [[nodiscard]] double least_inner_detour(const Move& move) {
    const std::span stretch = stretch_of(move);
    const auto is_in_stretch = [&](std::uint32_t stop) {
      return std::ranges::find(stretch, stop) != stretch.end();
    };
    LeastDetour& least = detours_[move.to][(move.count - 1) * problem_.stops + stretch.front()];
    const std::size_t found = std::exchange(least.found, links_noted_);
    if (found + 1 == links_noted_ && is_link(move.to, least.in) &&
        std::ranges::equal(stretch, std::span(least.stretch).first(move.count))) {
      const NumberTable& between = problem_.robots[move.to].between;
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
    const std::size_t inner = std::max<std::size_t>(first_free_place(move.to), 1),
                      size = tours_[move.to].size();
    if (move.to != move.from) {
      find_least_detour(move.to, stretch, inner, size, least);
    } else {
      find_least_detour(move.to, stretch, inner, move.begin, least);
      find_least_detour(move.to, stretch, move.end() + 1, size, least);
    }
    return least.added;
  }

  // What a robot needs more at least, wherever in its tour it takes in the stretch of a move.
  [[nodiscard]] double least_detour(const Move& move, double step_of_rest) {
    const std::span stretch = stretch_of(move);
    const Tour& tour = tours_[move.to];
    double least = TourProblem::kNever;
    const auto take_either_way = [&](const auto& added) {
      least =
          std::min({least, added(stretch.front(), stretch.back()), added(stretch.back(), stretch.front())});
    };
    const auto take_place = [&](std::size_t at) {
      take_either_way([&](std::uint32_t first, std::uint32_t last) {
        return detour(move.to, tour, steps_[move.to], at, first, last);
      });
    };
    const bool from_start = first_free_place(move.to) == 0;
    least = least_inner_detour(move);
    if (move.to != move.from) {
      if (from_start) take_place(0);
      take_place(tour.size());
      return least;
    }
    if (from_start && move.begin > 0) take_place(0);
    if (move.end() < tour.size()) take_place(tour.size());
    take_either_way([&](std::uint32_t first, std::uint32_t last) {  // where it was
      const TourProblem::Robot& robot = problem_.robots[move.to];
      const double to = move.begin == 0 ? robot.first[first] : robot.between(first, tour[move.begin - 1]);
      return move.end() == tour.size() ? to : to + robot.between(last, tour[move.end()]) - step_of_rest;
    });
    return least;
  }

  [[nodiscard]] double cost_of_move(const Move& move, const Rest& rest, double added) const {
    return move.to == move.from ? cost_with(move.from, rest.length + added, move.from, rest.length + added)
                                : cost_with(move.from, rest.length, move.to, lengths_[move.to] + added);
  }

  // The best move of a stretch that begins at a stop, but for the place in the tour where it leads.
  [[nodiscard]] Move best_move_from(std::size_t from, std::size_t begin) {
    Move best;
    for (std::size_t count = 1; count <= kMoved && begin + count <= tours_[from].size(); ++count) {
      Move move{.from = from, .begin = begin, .count = count};
      const Rest rest = rest_of(move);
      for (move.to = 0; move.to < tours_.size(); ++move.to) {
        const double within = time_within(problem_.robots[move.to], stretch_of(move));
        if (within == TourProblem::kNever) continue;
        move.cost = cost_of_move(move, rest, within + least_detour(move, rest.step));
        if (move.cost < best.cost) best = move;
      }
    }
    return best;
  }

  // The first place where the move costs least: what adds more may cost the same, after rounding.
  void find_place(Move& move) const {
    const Rest rest = rest_of(move);
    const std::span stretch = stretch_of(move);
    const double within = time_within(problem_.robots[move.to], stretch);
    Tour into = tours_[move.to];
    Steps steps = steps_[move.to];
    if (move.to == move.from) {
      const auto take_out = [&](auto& numbers) {
        numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(move.begin),
                      numbers.begin() + static_cast<std::ptrdiff_t>(move.end()));
      };
      take_out(into);
      take_out(steps);
      if (move.begin < into.size()) steps[move.begin] = rest.step;
    }
    Move best;
    for (move.at = std::min(problem_.robots[move.to].fixed, into.size()); move.at <= into.size(); ++move.at)
      for (const bool turned : {false, true}) {
        move.turned = turned;
        const std::uint32_t first = turned ? stretch.back() : stretch.front();
        const std::uint32_t last = turned ? stretch.front() : stretch.back();
        const double added = within + detour(move.to, into, steps, move.at, first, last);
        move.cost = cost_of_move(move, rest, added);
        if (move.cost < best.cost) best = move;
      }
    move = best;
  }

  // Or-opt: the best move of a few stops to another place, in their own tour or another one.
  bool move_stops() {
    note_links();
    std::vector<Move> moves;  // the best from each stop
    for (std::size_t from = 0; from < tours_.size(); ++from)
      for (std::size_t begin = problem_.robots[from].fixed; begin < tours_[from].size(); ++begin)
        moves.push_back({.from = from, .begin = begin});
    for_each_index(moves.size(),
                   [&](std::size_t i) { moves[i] = best_move_from(moves[i].from, moves[i].begin); });
    const auto best = std::ranges::min_element(moves, {}, &Move::cost);
    if (best == moves.end() || !(best->cost < cost() - kWorth)) return false;
    find_place(*best);
    take(*best);
    return true;
  }

  void take(const Move& move) {
    Tour& tour = tours_[move.from];
    const auto begin = tour.begin() + static_cast<std::ptrdiff_t>(move.begin);
    Tour stretch(begin, begin + static_cast<std::ptrdiff_t>(move.count));
    if (move.turned) std::ranges::reverse(stretch);
    tour.erase(begin, begin + static_cast<std::ptrdiff_t>(move.count));
    Tour& into = tours_[move.to];
    into.insert(into.begin() + static_cast<std::ptrdiff_t>(move.at), stretch.begin(), stretch.end());
    for (const std::size_t r : {move.from, move.to}) measure(r);
  }

  const TourProblem& problem_;
  Tours tours_;
  std::vector<Steps> steps_;
  std::vector<double> lengths_;
  // `stops_after` of each tour: when no stretch was worth turning, and when stops were last to be moved;
  // empty if that was never.
  std::vector<std::vector<std::uint32_t>> turned_, after_;
  std::vector<std::vector<Link>> new_links_;       // of each tour, since then
  std::size_t links_noted_ = 0;                    // so often
  std::vector<std::vector<LeastDetour>> detours_;  // in each tour, by number of stops and the first of them
};

}  // namespace

double TourProblem::length(std::size_t robot, const std::vector<std::uint32_t>& tour) const {
  double length = 0.0;
  for (std::size_t i = 0; i < tour.size(); ++i) length += step(robots[robot], tour, i);
  return length;
}

Tours shortened_tours(const TourProblem& problem, Tours tours) {
  Search search(problem, std::move(tours));
  search.insert_missing();
  search.improve();
  return search.take();
}

double cost_of(const TourProblem& problem, const Tours& tours) { return Search(problem, tours).cost(); }

}  // namespace frontlux::planner::detail
