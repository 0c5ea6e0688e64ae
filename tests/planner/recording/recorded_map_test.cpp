#include "support/complaint.hpp"
#include "support/random.hpp"

#include <frontlux/planner/recorded_map.hpp>

namespace frontlux::planner {
namespace {

using test::Random;

using Oracle = std::map<VoxelKey, Occupancy>;

constexpr int kEdge = 20;  // [voxels] more than two bricks
constexpr KeyBox kBox = cube({32760, 0, 65536 - kEdge}, kEdge);

// Robots move one after the other, and what each changed comes to one entry for each voxel.
RecordedStep play(Random& random, Oracle& oracle, int robots) {
  RecordedStep recorded;
  for (int robot = 0; robot < robots; ++robot) {
    const Oracle before = oracle;
    for (int scan = 0; scan < 300; ++scan)
      oracle[random.key_in(kBox)] = random.one_in(3) ? Occupancy::kOccupied : Occupancy::kFree;
    RobotStep& step = recorded.step.robots.emplace_back();
    for (const auto& [key, state] : oracle) {
      const auto entry = before.find(key);
      const Occupancy was = entry == before.end() ? Occupancy::kUnknown : entry->second;
      if (was != state) step.changed.push_back({key, was, state});
    }
  }
  return recorded;
}

void expect_equal(const RecordedMap& map, const Oracle& oracle) {
  for_each_key(kBox, [&](const VoxelKey& key) {
    const auto entry = oracle.find(key);
    const Occupancy state = entry == oracle.end() ? Occupancy::kUnknown : entry->second;
    ASSERT_EQ(map.grid().at(key), state) << key.x << " " << key.y << " " << key.z;
  });
  std::array<std::uint64_t, 3> count{};
  for (const auto& [key, state] : oracle) ++count[static_cast<std::size_t>(state)];
  EXPECT_EQ(map.grid().count()[1], count[1]);
  EXPECT_EQ(map.grid().count()[2], count[2]);
}

TEST(RecordedMap, FollowsTheSteps) {
  for (const int robots : {1, 2, 5}) {
    Random random(static_cast<std::uint64_t>(robots));
    RecordedMap map(0.3);
    Oracle oracle;
    expect_equal(map, oracle);
    for (int step = 0; step < 12; ++step) {
      const VoxelGrid before = map.grid();
      const auto count = before.count();
      map.apply(play(random, oracle, robots));
      expect_equal(map, oracle);
      EXPECT_EQ(before.count(), count) << "a copy of the grid is a snapshot";
    }
  }
}

TEST(RecordedMap, RefusesChangesOfAnotherMap) {
  const VoxelKey key{1, 1, 1}, other{1, 1, 2};
  RecordedStep step;
  step.step.number = 4;
  step.step.robots.resize(2);
  step.step.robots[0].changed = {{key, Occupancy::kUnknown, Occupancy::kFree}};
  step.step.robots[1].changed = {{key, Occupancy::kFree, Occupancy::kOccupied},
                                 {other, Occupancy::kOccupied, Occupancy::kFree}};
  RecordedMap map(0.3);
  EXPECT_EQ(test::complaint_of([&] { map.apply(step); }),
            "recorded map: step 4, robot 1: voxel (1, 1, 2) is unknown and not, as the step says, occupied");
  EXPECT_EQ(map.grid(), VoxelGrid(0.3)) << "as it was";
  step.step.robots[1].changed.pop_back();
  map.apply(step);
  EXPECT_EQ(map.grid().at(key), Occupancy::kOccupied);
  EXPECT_THROW(map.apply(step), std::invalid_argument) << "a second time";
}

TEST(RecordedMap, RefusesAResolutionThatIsNoLength) { EXPECT_THROW(RecordedMap(0.0), std::invalid_argument); }

}  // namespace
}  // namespace frontlux::planner
