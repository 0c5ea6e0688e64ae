#include "routing/complete_distances.hpp"

#include "routing/tour_problem.hpp"
#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

constexpr double kNever = TourProblem::kNever;

// Values against the sentence of its declaration, pair by pair.
TEST(CompleteDistances, GoByOneOtherPlaceOrByTheRobot) {
  test::Random random(5);
  for (int round = 0; round < 100; ++round) {
    const auto count = static_cast<std::size_t>(1 + random.below(9));
    NumberTable distances(count, count, kNever);
    std::vector<double> from_robot(count, kNever);
    std::vector<std::vector<double>> known(count, std::vector<double>(count, kNever));
    for (std::size_t i = 0; i < count; ++i) {
      if (random.below(4) != 0) from_robot[i] = random.uniform(0, 10);
      for (std::size_t j = 0; j < i; ++j)
        if (random.below(3) == 0) distances(i, j) = known[i][j] = known[j][i] = random.uniform(0, 10);
    }
    complete_distances(distances, from_robot);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) {
        if (i == j) continue;
        double expected = known[i][j];
        if (expected == kNever) {
          expected = from_robot[i] + from_robot[j];
          for (std::size_t k = 0; k < count; ++k) expected = std::min(expected, known[i][k] + known[k][j]);
        }
        EXPECT_DOUBLE_EQ(distances(i, j), expected) << "round " << round << ": " << i << ", " << j;
      }
  }
}

}  // namespace
}  // namespace frontlux::planner::detail
