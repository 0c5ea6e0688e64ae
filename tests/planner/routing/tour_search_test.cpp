#include "routing/tour_search.hpp"

#include "routing/measured_tours.hpp"
#include "routing/order_by_arrival.hpp"
#include "support/random.hpp"

#include <algorithm>
#include <optional>
#include <tuple>

namespace frontlux::planner::detail {
namespace {

using test::Random;

// Stops and robots at random places of a square; some stops are not for the last robot.
TourProblem random_problem(Random& random, std::size_t robots, std::size_t stops, bool choosy) {
  TourProblem problem;
  problem.stops = stops;
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 0; i < stops; ++i) places.emplace_back(random.uniform(0, 20), random.uniform(0, 20));
  for (std::size_t r = 0; r < robots; ++r) {
    const Eigen::Vector2d start(random.uniform(0, 20), random.uniform(0, 20));
    const double speed = random.uniform(0.5, 2.0);
    TourProblem::Robot robot{std::vector<double>(stops), NumberTable(stops, stops)};
    std::vector<bool> can(stops, true);
    if (choosy && r + 1 == robots)
      for (std::size_t i = 0; i < stops; ++i) can[i] = !random.one_in(3);
    for (std::size_t i = 0; i < stops; ++i) {
      robot.first[i] = can[i] ? (places[i] - start).norm() / speed : TourProblem::kNever;
      for (std::size_t j = 0; j < stops; ++j)
        robot.between(i, j) = can[i] && can[j] ? (places[i] - places[j]).norm() / speed : TourProblem::kNever;
    }
    problem.robots.push_back(std::move(robot));
  }
  return problem;
}

// [s] The times of the tours by the docs: the longest one, and a tenth of the sum of all.
double plain_cost(const TourProblem& problem, const Tours& tours) {
  double longest = 0.0, sum = 0.0;
  for (std::size_t r = 0; r < tours.size(); ++r) {
    const TourProblem::Robot& robot = problem.robots[r];
    double length = 0.0;
    for (std::size_t i = 0; i < tours[r].size(); ++i)
      length += i == 0 ? robot.first[tours[r][0]] : robot.between(tours[r][i - 1], tours[r][i]);
    longest = std::max(longest, length);
    sum += length;
  }
  return longest + 0.1 * sum;
}

// [s] Of one robot's order: its length, and three times the mean arrival.
double plain_cost_of_order(const TourProblem::Robot& robot, const std::vector<double>& weights,
                           const std::vector<std::uint32_t>& order) {
  double time = 0.0, arrivals = 0.0, all = 0.0;
  std::optional<std::uint32_t> before;
  for (const std::uint32_t stop : order) {
    time += before ? robot.between(*before, stop) : robot.first[stop];
    arrivals += weights[stop] * time;
    all += weights[stop];
    before = stop;
  }
  return time + 3.0 * arrivals / all;
}

// Stops and robots along a line; a robot takes a second for each metre.
TourProblem along_a_line(const std::vector<double>& stops, const std::vector<double>& robots) {
  TourProblem problem;
  problem.stops = stops.size();
  for (const double at : robots) {
    TourProblem::Robot robot{std::vector<double>(stops.size()), NumberTable(stops.size(), stops.size())};
    for (std::size_t i = 0; i < stops.size(); ++i) {
      robot.first[i] = std::abs(stops[i] - at);
      for (std::size_t j = 0; j < stops.size(); ++j) robot.between(i, j) = std::abs(stops[i] - stops[j]);
    }
    problem.robots.push_back(std::move(robot));
  }
  return problem;
}

// All orders of all ways to share the stops out.
double least_cost(const TourProblem& problem) {
  std::vector<std::uint32_t> order(problem.stops);
  std::iota(order.begin(), order.end(), 0u);
  double least = TourProblem::kNever;
  do {
    const std::size_t robots = problem.robots.size();
    for (std::size_t cut = 0; cut <= (robots == 1 ? 0 : problem.stops); ++cut) {
      Tours tours(robots);
      const auto middle = order.begin() + static_cast<std::ptrdiff_t>(cut);
      if (robots > 1) tours[1].assign(order.begin(), middle);
      tours[0].assign(middle, order.end());
      least = std::min(least, plain_cost(problem, tours));
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

std::size_t stops_in(const Tours& tours) {
  std::set<std::uint32_t> stops;
  std::size_t count = 0;
  for (const auto& tour : tours) {
    stops.insert(tour.begin(), tour.end());
    count += tour.size();
  }
  EXPECT_EQ(stops.size(), count) << "a stop is in two places";
  return count;
}

TEST(TourSearch, IsCloseToTheBestOfAllTours) {
  Random random(31);
  std::vector<double> ratios;
  for (int round = 0; round < 200; ++round) {
    const std::size_t robots = random.one_in(2) ? 2 : 1;
    const TourProblem problem =
        random_problem(random, robots, static_cast<std::size_t>(4 + random.below(3)), false);
    const Tours tours = shortened_tours(problem, {});
    EXPECT_EQ(stops_in(tours), problem.stops);
    ratios.push_back(plain_cost(problem, tours) / least_cost(problem));
    EXPECT_GE(ratios.back(), 1.0 - 1e-9);
  }
  std::ranges::sort(ratios);
  EXPECT_LT(ratios[ratios.size() / 2], 1.0 + 1e-9);  // half of them are the best
  EXPECT_LT(ratios[ratios.size() * 9 / 10], 1.06);
  EXPECT_LT(ratios.back(), 1.3);
}

TEST(TourSearch, NeverMakesToursLonger) {
  Random random(32);
  for (int round = 0; round < 100; ++round) {
    const TourProblem problem =
        random_problem(random, static_cast<std::size_t>(1 + random.below(4)), 20, false);
    Tours given(problem.robots.size());
    for (std::uint32_t i = 0; i < problem.stops; ++i)
      given[static_cast<std::size_t>(random.below(static_cast<int>(given.size())))].push_back(i);
    const Tours tours = shortened_tours(problem, given);
    EXPECT_EQ(stops_in(tours), problem.stops);
    EXPECT_LE(plain_cost(problem, tours), plain_cost(problem, given) + 1e-9);
    EXPECT_EQ(shortened_tours(problem, tours), tours);  // nothing is left to shorten
  }
}

// Two robots with stops at 5 and 10 m between them. Shared out, they cost max(5, d) + (5 + d) / 10 where d is
// from the second robot to the stop at 10 m; the first robot alone needs 10 + 10 / 10. They are equal at
// d = 10.5 / 1.1 = 9.55.
TEST(TourSearch, WeighsTheLongestTourAgainstATenthOfAll) {
  const auto tours = [](double d) { return shortened_tours(along_a_line({5, 10}, {0, 10 + d}), {}); };
  for (const double d : {9.0, 9.4}) EXPECT_EQ(tours(d), (Tours{{0}, {1}})) << d;
  for (const double d : {9.7, 9.8}) EXPECT_EQ(tours(d), (Tours{{0, 1}, {}})) << d;
}

TEST(TourSearch, SaysWhatToursCost) {
  Random random(38);
  for (int round = 0; round < 50; ++round) {
    const auto robots = static_cast<std::size_t>(1 + random.below(4));
    const TourProblem problem = random_problem(random, robots, 12, false);
    Tours tours(robots);
    for (std::uint32_t i = 0; i < problem.stops; ++i)
      tours[static_cast<std::size_t>(random.below(static_cast<int>(robots)))].push_back(i);
    EXPECT_NEAR(cost_of(problem, tours), plain_cost(problem, tours), 1e-9);
    const std::vector<double> weights(problem.stops, 2.0);
    if (!tours[0].empty()) {
      EXPECT_NEAR(cost_of_order(problem.robots[0], weights, tours[0]),
                  plain_cost_of_order(problem.robots[0], weights, tours[0]), 1e-9);
    }
  }
}

// Tours that are found have no stretch worth turning, and no few stops worth moving, whatever the search has
// kept of its steps before.
TEST(TourSearch, FindsNothingMoreToImprove) {
  constexpr double kRounding = 1e-5;
  Random random(11);
  for (int i = 0; i < 1500; ++i) {
    SCOPED_TRACE(i);
    const auto robots = static_cast<std::size_t>(1 + random.below(3)),
               stops = static_cast<std::size_t>(8 + random.below(25));
    TourProblem problem = random_problem(random, robots, stops, robots > 1);
    if (i % 3 == 0) problem.robots.front().fixed = 2;
    const Tours tours = shortened_tours(problem, {{0, 1}});
    const double cost = plain_cost(problem, tours);
    const auto expect_no_better = [&](const Tours& changed, auto... what) {
      EXPECT_GE(plain_cost(problem, changed), cost - kRounding)
          << ::testing::PrintToString(std::tuple(what...));
    };
    for (std::size_t r = 0; r < tours.size(); ++r)
      for (std::size_t begin = problem.robots[r].fixed; begin < tours[r].size(); ++begin)
        for (std::size_t end = begin + 1; end <= tours[r].size(); ++end) {
          const auto at = [](auto& tour, std::size_t place) {
            return tour.begin() + static_cast<std::ptrdiff_t>(place);
          };
          Tours turned = tours;
          std::reverse(at(turned[r], begin), at(turned[r], end));
          if (MeasuredTours(problem, turned).lengths[r] <
              MeasuredTours(problem, tours).lengths[r] - kRounding)
            ADD_FAILURE() << "a stretch of robot " << r << " from " << begin << " to " << end;
          if (end - begin > 3) continue;
          for (const bool other_way : {false, true})
            for (std::size_t to = 0; to < tours.size(); ++to) {
              Tours without = tours;
              std::vector<std::uint32_t> stretch(at(without[r], begin), at(without[r], end));
              if (other_way) std::ranges::reverse(stretch);
              without[r].erase(at(without[r], begin), at(without[r], end));
              for (std::size_t place = problem.robots[to].fixed; place <= without[to].size(); ++place) {
                Tours moved = without;
                moved[to].insert(at(moved[to], place), stretch.begin(), stretch.end());
                expect_no_better(moved, r, begin, end, other_way, to, place);
              }
            }
        }
  }
}

TEST(TourSearch, LeavesToRobotsWhatOnlyTheyCanDo) {
  Random random(33);
  for (int round = 0; round < 100; ++round) {
    const TourProblem problem = random_problem(random, 2, 12, true);
    const Tours tours = shortened_tours(problem, {});
    EXPECT_EQ(stops_in(tours), problem.stops);
    for (const std::uint32_t stop : tours[1]) EXPECT_NE(problem.robots[1].first[stop], TourProblem::kNever);
  }
}

TEST(TourSearch, LeavesOutWhatNobodyCanDo) {
  Random random(34);
  TourProblem problem = random_problem(random, 1, 5, false);
  problem.robots[0].first[2] = TourProblem::kNever;
  for (std::size_t i = 0; i < 5; ++i)
    problem.robots[0].between(2, i) = problem.robots[0].between(i, 2) = TourProblem::kNever;
  const Tours tours = shortened_tours(problem, {});
  EXPECT_EQ(stops_in(tours), 4u);
  EXPECT_TRUE(std::ranges::find(tours[0], 2u) == tours[0].end());
}

TEST(TourSearch, KeepsFixedStopsFirst) {
  Random random(35);
  for (int round = 0; round < 100; ++round) {
    TourProblem problem = random_problem(random, 2, 10, false);
    problem.robots[1].fixed = 1;
    const Tours tours = shortened_tours(problem, {{}, {7}});
    ASSERT_FALSE(tours[1].empty());
    EXPECT_EQ(tours[1].front(), 7u);
    EXPECT_EQ(stops_in(tours), problem.stops);
  }
}

std::vector<double> random_weights(Random& random, std::size_t count) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < count; ++i) weights.push_back(1 + random.below(4));
  return weights;
}

TEST(SoonestOrder, IsCloseToTheBestOfAllOrders) {
  Random random(36);
  std::size_t best = 0;
  for (int round = 0; round < 200; ++round) {
    const TourProblem problem = random_problem(random, 1, 6, false);
    const TourProblem::Robot& robot = problem.robots[0];
    const std::vector<double> weights = random_weights(random, 6);
    std::vector<std::uint32_t> order(6);
    std::iota(order.begin(), order.end(), 0u);
    double least = TourProblem::kNever;
    do least = std::min(least, plain_cost_of_order(robot, weights, order));
    while (std::next_permutation(order.begin(), order.end()));
    const double found = plain_cost_of_order(robot, weights, order_by_arrival(robot, weights, order));
    EXPECT_GE(found, least - 1e-9);
    EXPECT_LT(found, 1.3 * least);
    best += found < least + 1e-9 ? 1 : 0;
  }
  EXPECT_GT(best, 150u);
}

TEST(SoonestOrder, KeepsAllStopsAndNeverGetsWorse) {
  Random random(37);
  for (int round = 0; round < 20; ++round) {
    const TourProblem problem = random_problem(random, 1, 30, false);
    const TourProblem::Robot& robot = problem.robots[0];
    const std::vector<double> weights = random_weights(random, 30);
    std::vector<std::uint32_t> given(30);
    std::iota(given.begin(), given.end(), 0u);
    for (std::size_t i = given.size(); i > 1; --i)
      std::swap(given[i - 1], given[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    const auto order = order_by_arrival(robot, weights, given);
    EXPECT_EQ(stops_in({order}), 30u);
    EXPECT_LE(plain_cost_of_order(robot, weights, order), plain_cost_of_order(robot, weights, given));
    EXPECT_EQ(order_by_arrival(robot, weights, order), order);  // nothing is left to improve
  }
}

// Along a line: a far stop on one side, three on the other side, a little farther each. A short tour begins
// with the single one, a soon one with the three.
TEST(SoonestOrder, TakesManyStopsBeforeOne) {
  const TourProblem problem = along_a_line({-1.0, 1.2, 1.3, 1.4}, {0.0});
  const TourProblem::Robot& robot = problem.robots[0];
  EXPECT_EQ(shortened_tours(problem, {}).front(), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(order_by_arrival(robot, std::vector<double>(4, 1.0), {0, 1, 2, 3}),
            (std::vector<std::uint32_t>{1, 2, 3, 0}));
  EXPECT_EQ(order_by_arrival(robot, std::vector<double>{9.0, 1.0, 1.0, 1.0}, {1, 2, 3, 0}),
            (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

// A stop at -1 m, and three times as much to see at d. That first costs d - 1 more of length, and
// (2 d - 6) / 4 less of the mean arrival, which counts three times: d = 5.5 / 2.5 = 2.2 is as good either
// way.
TEST(SoonestOrder, WeighsTheLengthAgainstThreeMeanArrivals) {
  const auto order = [](double d, std::vector<std::uint32_t> given) {
    return order_by_arrival(along_a_line({-1.0, d}, {0.0}).robots[0], std::vector<double>{1.0, 3.0},
                            std::move(given));
  };
  for (const auto& given : {std::vector<std::uint32_t>{0, 1}, {1, 0}}) {
    EXPECT_EQ(order(2.12, given), (std::vector<std::uint32_t>{1, 0}));
    EXPECT_EQ(order(2.28, given), (std::vector<std::uint32_t>{0, 1}));
  }
}

TEST(SoonestOrder, OfNothingIsNothing) { EXPECT_TRUE(order_by_arrival({}, {}, {}).empty()); }

TEST(TourSearch, HasNoToursWithoutRobotsOrStops) {
  EXPECT_TRUE(shortened_tours({}, {}).empty());
  TourProblem problem;
  problem.robots.resize(2);
  EXPECT_EQ(shortened_tours(problem, {}), Tours(2));
}

}  // namespace
}  // namespace frontlux::planner::detail
