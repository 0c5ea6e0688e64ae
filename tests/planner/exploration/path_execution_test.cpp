#include "exploration/path_execution.hpp"

#include "support/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace frontlux::planner {
namespace {

using test::Random;

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

// A range along one direction, from a viewpoint.
Scan scan_along(const Pose& from, const Eigen::Vector3f& direction, float range) {
  Scan scan;
  scan.origin = from.position.cast<float>();
  scan.max_range = 10.0;
  scan.directions = {direction};
  scan.ranges = {range};
  return scan;
}

// A free hall of 6 x 3 x 3 m whose lower corner is the origin, and a robot of 0.8 m that crosses it.
class PathExecutionTest : public testing::Test {
 protected:
  PathExecutionTest() : mapping_({}) {
    mapping_.mark_free(Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(6, 3, 3)));
    for (int i = 0; i < 5; ++i) way_.push_back({{1.05 + 0.9 * i, 1.35, 1.35}, 0.1 * i});
  }

  Mapping mapping_;
  std::vector<Pose> way_;
  TravelOptions body_ = uav_travel();
};

TEST(Differences, AreThoseOfEveryVoxel) {
  Random random(5);
  const auto key = [&](int edge) {
    const auto along = [&] { return static_cast<std::uint16_t>(32760 + random.below(edge)); };
    return VoxelKey{along(), along(), along()};
  };
  VoxelGrid before(0.3);
  for (int i = 0; i < 3000; ++i) before.set(key(16), static_cast<Occupancy>(random.below(3)));
  VoxelGrid after = before;
  for (int i = 0; i < 900; ++i) after.set(key(16), static_cast<Occupancy>(random.below(3)));
  std::vector<VoxelKey> candidates;
  for (int i = 0; i < 5000; ++i) candidates.push_back(key(20));
  std::map<VoxelKey, VoxelChange> expected;
  for (const VoxelKey& k : candidates)
    if (before.at(k) != after.at(k)) expected[k] = {k, before.at(k), after.at(k)};
  std::vector<VoxelChange> sorted;
  for (const auto& [k, change] : expected) sorted.push_back(change);
  EXPECT_GT(sorted.size(), 200U);
  EXPECT_EQ(detail::differences(before, after, candidates), sorted);
  EXPECT_TRUE(detail::differences(before, before, candidates).empty());
  EXPECT_TRUE(detail::differences(before, after, {}).empty());
}

// It stands off the middle of its voxel, so that its box of 0.8 m reaches into voxels that the box around the
// middle is clear of; one of them turns out to be occupied.
TEST_F(PathExecutionTest, LeavesWhereItStandsByTheMiddleOfItsVoxel) {
  const Lattice lattice = mapping_.grid().lattice();
  const auto key = [&](double x, double y, double z) {
    return VoxelKey{*lattice.key(x), *lattice.key(y), *lattice.key(z)};
  };
  const auto center = [&](double along) { return lattice.center(*lattice.key(along)); };
  const Pose beside{{1.05, 1.275, 1.25}, 0.0}, middle{{1.05, center(1.275), center(1.25)}, 0.0};
  static_cast<void>(mapping_.insert(scan_along({{1.05, 2.55, 1.35}, 0.0}, {0, -1, 0}, 1.69F)));
  ASSERT_EQ(mapping_.grid().at(key(1.05, 0.85, 1.35)), Occupancy::kOccupied);
  const Drive drive = [](std::size_t, const Pose& to) { return scan_along(to, {1, 0, 0}, 2.0F); };
  const auto travelled = [&](std::vector<Pose> way) {
    return detail::travel(0, way, &body_, drive, mapping_).travelled;
  };
  EXPECT_EQ(travelled({beside, way_[1]}), 1U) << "past what is beside it";
  EXPECT_EQ(travelled({beside, middle, way_[1]}), 3U);
  EXPECT_EQ(travelled({beside, {{1.05, 1.29, 1.3}, 0.0}}), 1U) << "not far enough to be clear of it";
  EXPECT_EQ(travelled({beside, {{1.05, 1.21, 1.3}, 0.0}}), 1U) << "away from the middle";
}

TEST_F(PathExecutionTest, MeasuresAtEveryViewpointButTheFirst) {
  const VoxelGrid before = mapping_.grid();
  std::vector<Pose> asked;
  const Drive drive = [&](std::size_t robot, const Pose& to) {
    EXPECT_EQ(robot, 3U);
    asked.push_back(to);
    return scan_along(to, {0, 1, 0}, 2.5F);
  };
  const detail::PathExecution journey = detail::travel(3, way_, &body_, drive, mapping_);
  EXPECT_EQ(journey.travelled, 5U);
  EXPECT_NEAR(journey.length, 3.6, 1e-12);
  ASSERT_EQ(asked.size(), 4U);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    EXPECT_EQ(asked[i].position, way_[i + 1].position);
    EXPECT_EQ(asked[i].yaw, way_[i + 1].yaw);
  }
  // Free from the viewpoint at y = 1.35 to the hall's end at 3 was known; 3 to 3.85 and a hit there is new:
  // two free voxels and an occupied one, for each of the four columns.
  EXPECT_EQ(journey.changed.size(), 12U);
  for (const VoxelChange& change : journey.changed) {
    EXPECT_EQ(change.before, before.at(change.key));
    EXPECT_EQ(change.after, mapping_.grid().at(change.key));
    EXPECT_NE(change.before, change.after);
  }
}

TEST_F(PathExecutionTest, StopsWhereAScanShowsTheWayToBeBlocked) {
  // From its second place it finds something 1.5 m ahead, so in the box around the fourth, 1.8 m ahead, and
  // also in that around the third but for the voxel between: the third is 0.9 m ahead, 0.4 wide.
  const auto run = [&](float distance, const TravelOptions* body) {
    Mapping mapping({});
    mapping.mark_free(Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(6, 3, 3)));
    const Drive drive = [&](std::size_t, const Pose& to) {
      return to.position == way_[1].position ? scan_along(to, {1, 0, 0}, distance)
                                             : scan_along(to, {1, 0, 0}, kNothing);
    };
    return detail::travel(0, way_, body, drive, mapping);
  };
  // x of the hit: 1.95 + distance. Boxes of 3 voxels around 2.85, 3.75 and 4.65 begin at 2.4, 3.3 and 4.2.
  EXPECT_EQ(run(2.5F, &body_).travelled, 4U);  // at 4.45: only the last is blocked
  EXPECT_EQ(run(1.5F, &body_).travelled, 3U);  // at 3.45
  EXPECT_EQ(run(0.6F, &body_).travelled, 2U);  // at 2.55
  EXPECT_NEAR(run(0.6F, &body_).length, 0.9, 1e-12);
  EXPECT_EQ(run(0.6F, nullptr).travelled, 5U) << "with no body the ways are not checked";
}

// It does not come to the place that it was refused, turns to it from where it is, looks, and ends there.
TEST_F(PathExecutionTest, LooksAtWhatIsInItsWay) {
  const Lattice& lattice = mapping_.grid().lattice();
  for (std::size_t refused = 1; refused < way_.size(); ++refused) {
    std::vector<Pose> way = way_, asked;
    way[1].position.y() += 0.6;  // so that not all ways have the same direction
    const Drive drive = [&](std::size_t, const Pose& to) -> std::optional<Scan> {
      asked.push_back(to);
      if (asked.size() == refused) return std::nullopt;
      return scan_along(to, {1, 0, 0}, kNothing);
    };
    const std::vector<Pose> planned = way;
    const detail::PathExecution journey = detail::travel(0, way, &body_, drive, mapping_);
    ASSERT_EQ(asked.size(), refused + 1);
    EXPECT_EQ(journey.travelled, refused + 1);
    EXPECT_TRUE(journey.changed.empty());
    const Pose &from = planned[refused - 1], &to = planned[refused];
    EXPECT_EQ(asked.back().position, from.position);
    const Eigen::Vector3d on = to.position - from.position;
    EXPECT_NEAR(asked.back().yaw, std::atan2(on.y(), on.x()), 1e-12);
    EXPECT_EQ(way[refused].position, asked.back().position);
    EXPECT_EQ(way[refused].yaw, asked.back().yaw);
    double length = 0.0;
    for (std::size_t i = 1; i < refused; ++i)
      length += (planned[i].position - planned[i - 1].position).norm();
    EXPECT_NEAR(journey.length, length, 1e-12);
    // Blocked: what points along the way lie in, but where it begins.
    const auto key_at = [&](const Eigen::Vector3d& at) { return lattice.key(at.cast<float>()).value(); };
    std::set<VoxelKey> expected;
    for (int part = 0; part <= 10'000; ++part) expected.insert(key_at(from.position + on * part / 10'000));
    expected.erase(key_at(from.position));
    const std::set<VoxelKey> blocked(journey.blocked.begin(), journey.blocked.end());
    EXPECT_TRUE(std::ranges::includes(blocked, expected)) << "way " << refused;
    EXPECT_TRUE(std::ranges::is_sorted(journey.blocked));
    EXPECT_FALSE(blocked.contains(key_at(from.position)));
    EXPECT_LE(blocked.size(), expected.size() + 2) << "besides, such as it only touches";
  }
}

TEST_F(PathExecutionTest, EndsWithARobotThatNeitherGoesNorLooks) {
  for (std::size_t refused = 1; refused < way_.size(); ++refused) {
    std::vector<Pose> way = way_;
    std::size_t calls = 0;
    const Drive drive = [&](std::size_t, const Pose& to) -> std::optional<Scan> {
      if (++calls >= refused) return std::nullopt;
      return scan_along(to, {1, 0, 0}, kNothing);
    };
    const detail::PathExecution journey = detail::travel(0, way, &body_, drive, mapping_);
    EXPECT_EQ(calls, refused + 1);
    EXPECT_EQ(journey.travelled, refused);
    EXPECT_NEAR(journey.length, 0.9 * static_cast<double>(refused - 1), 1e-12);
    EXPECT_FALSE(journey.blocked.empty());
  }
}

TEST_F(PathExecutionTest, OfOnePlaceOrNoneMeasuresNothing) {
  const Drive drive = [&](std::size_t, const Pose&) -> std::optional<Scan> {
    ADD_FAILURE() << "asked to drive";
    return std::nullopt;
  };
  const detail::PathExecution none = detail::travel(0, {}, &body_, drive, mapping_);
  EXPECT_EQ(none.travelled, 0U);
  EXPECT_EQ(none.length, 0.0);
  const detail::PathExecution one = detail::travel(0, std::span(way_).first(1), &body_, drive, mapping_);
  EXPECT_EQ(one.travelled, 1U);
  EXPECT_EQ(one.length, 0.0);
}

}  // namespace
}  // namespace frontlux::planner
