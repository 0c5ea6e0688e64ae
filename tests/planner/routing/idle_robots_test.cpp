#include "routing/idle_robots.hpp"

#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

// Stops along a line; a robot takes a second for each metre.
struct Line {
  std::vector<double> stops;
  std::vector<double> robots;
  [[nodiscard]] TourProblem problem() const {
    TourProblem problem;
    problem.stops = stops.size();
    for (const double robot : robots) {
      TourProblem::Robot times{{}, NumberTable(stops.size(), stops.size())};
      for (std::size_t i = 0; i < stops.size(); ++i) {
        times.first.push_back(std::abs(stops[i] - robot));
        for (std::size_t j = 0; j < stops.size(); ++j) times.between(i, j) = std::abs(stops[i] - stops[j]);
      }
      problem.robots.push_back(std::move(times));
    }
    return problem;
  }
};

TEST(IdleRobots, TakeWhatTheOtherOneReachesMuchLater) {
  const TourProblem problem = Line{{10, 20, 40, 100}, {0, 45}}.problem();
  Tours tours{{0, 1, 2, 3}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0, 1, 3}, {2}})) << "the nearest one, not the last";
}

TEST(IdleRobots, RestWhereTheyWouldNotBeMuchSooner) {
  const TourProblem problem =
      Line{{10, 20, 40}, {0, 62}}.problem();  // 22 s to 40, where the other is after 40 s
  Tours tours{{0, 1, 2}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0, 1, 2}, {}}));
}

TEST(IdleRobots, RestWhereTheyWouldBeBarelySooner) {
  const TourProblem problem = Line{{1, 7}, {0, 10}}.problem();  // 3 s to 7, where the other is after 7 s
  Tours tours{{0, 1}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0, 1}, {}}));
}

// 5 s sooner, and in half of the time: what is just so, and what just not.
TEST(IdleRobots, TakeWhatTheyReachFiveSecondsSoonerInHalfOfTheTime) {
  const auto takes = [](const std::vector<double>& stops, double idle) {
    Tours tours{{0, 1}, {}};
    give_idle_robot_a_stop(Line{stops, {0, idle}}.problem(), 1, tours);
    return tours == Tours{{0}, {1}};
  };
  EXPECT_TRUE(takes({1, 7}, 7 + 1.9)) << "5.1 s sooner";
  EXPECT_FALSE(takes({1, 7}, 7 + 2.1)) << "4.9 s sooner";
  EXPECT_TRUE(takes({20, 40}, 40 + 19.9));
  EXPECT_FALSE(takes({20, 40}, 40 + 20.1)) << "19.9 s sooner, but in more than half of the time";
}

TEST(IdleRobots, LeaveWhatTheOtherOneSetsOutFor) {
  TourProblem problem = Line{{40, 41, 42}, {0, 45}}.problem();
  Tours tours{{0}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0}, {}}));
  problem.robots[0].fixed = 2;
  tours = {{0, 1, 2}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0, 1}, {2}}));
}

TEST(IdleRobots, TakeWhatIsLeftToOneThatRests) {
  TourProblem problem = Line{{10, 40}, {0, 45}}.problem();
  Tours tours{{0, 1}, {}};
  problem.robots[0].rests = true;
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0}, {1}})) << "the nearest one";
  tours = {{0}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{}, {0}})) << "the first one, and though the other is nearer";
}

TEST(IdleRobots, LeaveWhatIsNotForThem) {
  TourProblem problem = Line{{10, 40, 44}, {0, 45}}.problem();
  problem.robots[1].first[2] = TourProblem::kNever;
  Tours tours{{0, 1, 2}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0, 2}, {1}}));
  for (double& seconds : problem.robots[1].first) seconds = TourProblem::kNever;
  tours = {{0, 1, 2}, {}};
  give_idle_robot_a_stop(problem, 1, tours);
  EXPECT_EQ(tours, (Tours{{0, 1, 2}, {}}));
}

TEST(IdleRobots, NoStopIsLostAndWhoHasStopsGetsNone) {
  test::Random random(3);
  for (int round = 0; round < 300; ++round) {
    Line line;
    for (int i = random.below(9); i > 0; --i) line.stops.push_back(random.uniform(0, 100));
    for (int i = 1 + random.below(4); i > 0; --i) line.robots.push_back(random.uniform(0, 100));
    Tours tours(line.robots.size());
    for (std::uint32_t i = 0; i < line.stops.size(); ++i)
      tours[static_cast<std::size_t>(random.below(static_cast<int>(tours.size())))].push_back(i);
    const Tours before = tours;
    const auto idle = static_cast<std::size_t>(random.below(static_cast<int>(tours.size())));
    give_idle_robot_a_stop(line.problem(), idle, tours);
    std::vector<std::uint32_t> stops;
    for (std::size_t r = 0; r < tours.size(); ++r) {
      stops.insert(stops.end(), tours[r].begin(), tours[r].end());
      EXPECT_LE(tours[r].size(), std::max<std::size_t>(before[r].size(), r == idle ? 1 : 0));
      if (!before[r].empty()) {
        EXPECT_EQ(tours[r].front(), before[r].front());
      }
    }
    std::ranges::sort(stops);
    for (std::uint32_t i = 0; i < stops.size(); ++i) EXPECT_EQ(stops[i], i);
    EXPECT_EQ(stops.size(), line.stops.size());
  }
}

}  // namespace
}  // namespace frontlux::planner::detail
