#include "routing/shortest_choice.hpp"

#include "support/random.hpp"

namespace frontlux::planner::detail {
namespace {

using Stages = std::vector<std::vector<std::size_t>>;

TEST(ShortestChoice, IsTheBestOfAllChoices) {
  test::Random random(81);
  for (int round = 0; round < 200; ++round) {
    Stages stages;
    std::size_t places = 0;
    for (int s = 1 + random.below(5); s > 0; --s) {
      stages.emplace_back();
      for (int i = 1 + random.below(4); i > 0; --i) stages.back().push_back(places++);
    }
    std::vector<double> first(places);
    for (double& cost : first) cost = random.uniform(0, 10);
    std::vector<std::vector<double>> between(places, first);
    for (auto& row : between)
      for (double& cost : row) cost = random.uniform(0, 10);
    const auto cost_of = [&](const std::vector<std::size_t>& choice) {
      double cost = first[choice[0]];
      for (std::size_t s = 1; s < choice.size(); ++s) cost += between[choice[s - 1]][choice[s]];
      return cost;
    };
    std::vector<std::vector<std::size_t>> all = {{}};
    for (const auto& stage : stages) {
      std::vector<std::vector<std::size_t>> longer;
      for (const auto& begun : all)
        for (const std::size_t place : stage) {
          longer.push_back(begun);
          longer.back().push_back(place);
        }
      all = std::move(longer);
    }
    double least = std::numeric_limits<double>::infinity();
    for (const auto& choice : all) least = std::min(least, cost_of(choice));
    const auto found = shortest_choice(
        stages, [&](std::size_t a) { return first[a]; },
        [&](std::size_t a, std::size_t b) { return between[a][b]; });
    ASSERT_EQ(found.size(), stages.size());
    for (std::size_t s = 0; s < stages.size(); ++s)
      EXPECT_TRUE(std::ranges::find(stages[s], found[s]) != stages[s].end());
    EXPECT_NEAR(cost_of(found), least, 1e-9);
  }
}

TEST(ShortestChoice, OfNoStagesIsNone) {
  const auto free = [](auto...) { return 0.0; };
  EXPECT_TRUE(shortest_choice(Stages(), free, free).empty());
}

}  // namespace
}  // namespace frontlux::planner::detail
