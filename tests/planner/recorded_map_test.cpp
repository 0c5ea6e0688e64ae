#include "support/random.hpp"

#include <frontlux/planner/recorded_map.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace frontlux::planner {
namespace {

using test::Random;

struct Known {
  Occupancy state = Occupancy::kUnknown;
  std::optional<std::size_t> seen_by;
};
using Oracle = std::map<VoxelKey, Known>;

constexpr int kEdge = 20;  // [voxels] more than two bricks

VoxelKey random_key(Random& random) {
  const auto along = [&](int from) { return static_cast<std::uint16_t>(from + random.below(kEdge)); };
  return {along(32760), along(0), along(65536 - kEdge)};
}

RecordingHead head_of(Random& random, int robots) {
  RecordingHead head;
  for (int i = 0; i < robots; ++i) {
    head.robots.emplace_back();
    head.starts.emplace_back();
    for (int k = 0; k < 30; ++k) head.starts.back().known_free.push_back(random_key(random));
  }
  return head;
}

Oracle begin_of(const RecordingHead& head) {
  Oracle oracle;
  for (std::size_t robot = 0; robot < head.starts.size(); ++robot)
    for (const VoxelKey& key : head.starts[robot].known_free) {
      Known& known = oracle[key];
      known.state = Occupancy::kFree;
      if (!known.seen_by) known.seen_by = robot;
    }
  return oracle;
}

// Robots take turns, and each notes what its own turn changes: so one voxel may change several times in a
// step, and a robot's list tells of all of them.
RecordedStep play(Random& random, Oracle& oracle, int robots, bool several_times) {
  RecordedStep recorded;
  recorded.step.robots.resize(static_cast<std::size_t>(robots));
  Oracle touched;
  for (int turn = 0; turn < 400; ++turn) {
    const auto robot = static_cast<std::size_t>(random.below(robots));
    const VoxelKey key = random_key(random);
    if (!several_times && !touched.emplace(key, Known{}).second) continue;
    Known& known = oracle[key];
    const auto after = random.one_in(3) ? Occupancy::kOccupied : Occupancy::kFree;
    if (after == known.state) continue;
    recorded.step.robots[robot].changed.push_back({key, known.state, after});
    known.state = after;
    if (!known.seen_by) known.seen_by = robot;
  }
  for (RobotStep& robot : recorded.step.robots)
    std::stable_sort(robot.changed.begin(), robot.changed.end(),
                     [](const VoxelChange& a, const VoxelChange& b) { return a.key < b.key; });
  return recorded;
}

void expect_equal(const RecordedMap& map, const Oracle& oracle) {
  for (int x = 0; x < kEdge; ++x)
    for (int y = 0; y < kEdge; ++y)
      for (int z = 0; z < kEdge; ++z) {
        const VoxelKey key{static_cast<std::uint16_t>(32760 + x), static_cast<std::uint16_t>(y),
                           static_cast<std::uint16_t>(65536 - kEdge + z)};
        const auto entry = oracle.find(key);
        const Known known = entry == oracle.end() ? Known{} : entry->second;
        ASSERT_EQ(map.grid().at(key), known.state) << x << " " << y << " " << z;
        ASSERT_EQ(map.first_seen_by(key), known.seen_by) << x << " " << y << " " << z;
      }
  std::array<std::uint64_t, 3> count{};
  for (const auto& [key, known] : oracle) ++count[static_cast<std::size_t>(known.state)];
  EXPECT_EQ(map.grid().count()[1], count[1]);
  EXPECT_EQ(map.grid().count()[2], count[2]);
}

TEST(RecordedMap, FollowsTheSteps) {
  for (const bool several_times : {false, true})
    for (const int robots : {1, 2, 5}) {
      Random random(static_cast<std::uint64_t>(robots));
      const RecordingHead head = head_of(random, robots);
      RecordedMap map(head);
      Oracle oracle = begin_of(head);
      expect_equal(map, oracle);
      for (int step = 0; step < 20; ++step) {
        const VoxelGrid before = map.grid();
        const auto free = before.count();
        map.apply(play(random, oracle, robots, several_times));
        expect_equal(map, oracle);
        EXPECT_EQ(before.count(), free) << "a copy of the grid is a snapshot";
      }
    }
}

TEST(RecordedMap, WhatIsKnownAtTheStartMayBeAChangeOfStepZero) {
  const VoxelKey key{1, 2, 3};
  RecordingHead head;
  head.robots.resize(2);
  head.starts.resize(2);
  head.starts[0].known_free = {key};
  RecordedStep step;
  step.step.robots.resize(2);
  step.step.robots[0].changed = {{key, Occupancy::kUnknown, Occupancy::kOccupied}};
  RecordedMap map(head);
  map.apply(step);
  EXPECT_EQ(map.grid().at(key), Occupancy::kOccupied);
  EXPECT_EQ(map.first_seen_by(key), 0U);
}

TEST(RecordedMap, OutsideTheBoundsNothingIsKnownAtTheStart) {
  RecordingHead head;
  head.bounds = {{0, 0, 0}, {9, 9, 9}};
  head.robots.resize(1);
  head.starts.resize(1);
  head.starts[0].known_free = {{9, 9, 9}, {9, 9, 10}};
  const RecordedMap map(head);
  EXPECT_EQ(map.grid().count()[1], 1U);
  EXPECT_EQ(map.first_seen_by({9, 9, 10}), std::nullopt);
}

TEST(RecordedMap, RefusesChangesOfAnotherMap) {
  RecordingHead head;
  head.robots.resize(1);
  head.starts.resize(1);
  RecordedStep step;
  step.step.robots.resize(1);
  step.step.robots[0].changed = {{{1, 1, 1}, Occupancy::kUnknown, Occupancy::kFree},
                                 {{1, 1, 2}, Occupancy::kOccupied, Occupancy::kFree}};
  RecordedMap map(head);
  EXPECT_THROW(map.apply(step), std::invalid_argument);
  EXPECT_EQ(map.grid().count()[1], 0U) << "as it was";
}

}  // namespace
}  // namespace frontlux::planner
