// Guards what explorations come to: coverage by step, no contacts, an end of their own. The thresholds lie
// some percent below the least of three seeds when this was written.

#include "planner/exploration/team_in_world.hpp"
#include "support/maps.hpp"

#include <frontlux/sim/coverage.hpp>

#include <string_view>

namespace frontlux::planner {
namespace {

using test::TeamInWorld;
using test::uav_and_ugv;

/// Explores to the end.
/// @param least  by step, the coverage of observable space at its end
void expect_coverage(std::string_view world, std::uint64_t seed,
                     const std::vector<std::pair<std::size_t, double>>& least, std::size_t most_steps) {
  SCOPED_TRACE(std::string(world) + ", seed " + std::to_string(seed));
  const TeamInWorld team(world, seed, uav_and_ugv());
  sim::SimulatedRobots robots = team.bodies(sim::AtContact::kStay);
  Exploration exploration(team.options(), team.empty_map());
  std::size_t stops = 0;  // by bumpers
  const Drive drive = [&](std::size_t robot, const Pose& viewpoint) {
    auto scan = robots.drive(robot, viewpoint);
    stops += scan ? 0 : 1;
    return scan;
  };
  exploration.begin(team.starts, drive);
  std::vector<double> curve = {sim::measure(team.truth, exploration.mapping().grid()).of_observable()};
  while (!exploration.end() && curve.size() <= most_steps) {
    exploration.step(drive);
    curve.push_back(sim::measure(team.truth, exploration.mapping().grid()).of_observable());
  }
  ASSERT_TRUE(exploration.end().has_value()) << "no end after " << curve.size() - 1 << " steps";
  EXPECT_NE(exploration.end(), ExplorationEnd::kStepLimit);
  for (const auto& [step, coverage] : least)
    EXPECT_GE(curve[std::min(step, curve.size() - 1)], coverage) << "at step " << step;
  EXPECT_EQ(robots.contacts(), 0U);
  EXPECT_LE(stops, 1U) << "paths lead where bodies do not fit";
}

TEST(ExplorationCoverage, OfARoom) {
  // 97 to 97.4 % or 84.8 % after two steps, 99.5 to 100 % after three, ends after 4 or 5.
  for (const std::uint64_t seed : {1U, 2U, 3U})
    expect_coverage("room", seed, {{2, 0.75}, {4, 0.97}, {12, 0.99}}, 15);
}

TEST(ExplorationCoverage, OfAStorage) {
  // 76.0 to 78.7 % after 10 steps, 94.6 to 96.9 % after 20, 99.6 to 99.9 % after 28, ends after 32 to 38.
  for (const std::uint64_t seed : {2U, 1U, 3U}) {
    expect_coverage("storage", seed, {{10, 0.70}, {20, 0.90}, {28, 0.97}, {60, 0.99}}, 60);
    if (!test::long_mode()) break;
  }
}

}  // namespace
}  // namespace frontlux::planner
