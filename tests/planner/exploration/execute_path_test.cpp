#include "exploration/execute_path.hpp"

#include "support/voxel_keys.hpp"

#include <frontlux/planner/body_stencil.hpp>

namespace frontlux::planner {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

// A range along one direction, from a viewpoint.
Scan scan_along(const Pose& from, const Eigen::Vector3f& direction, float range) {
  return {from.position.cast<float>(), 10.0, {direction}, {range}};
}

// A free hall of 6 x 3 x 3 m whose lower corner is the origin, and a robot of 0.8 m that crosses it.
class ExecutePathTest : public testing::Test {
 protected:
  ExecutePathTest() {
    for (int i = 0; i < 5; ++i) path_.push_back({{1.05 + 0.9 * i, 1.35, 1.35}, 0.1 * i});
  }

  static Mapping hall() {
    Mapping mapping({});
    mapping.mark_free(test::keys_of(
        voxels_of(mapping.grid().lattice(), {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(6, 3, 3)})));
    return mapping;
  }
  RobotStep execute(std::vector<Pose> path, const BodyStencil* body, const Drive& drive, Mapping& mapping,
                    std::size_t robot = 0) {
    RobotStep step;
    step.planned = std::move(path);
    reached_ = detail::execute_path(robot, step, body, drive, mapping);
    return step;
  }

  Mapping mapping_ = hall();
  std::vector<Pose> path_;
  BodyStencil body_{uav_travel(), mapping_.grid().resolution()};
  std::size_t reached_ = 0;  // viewpoints, by what was executed last
};

// It stands off the middle of its voxel, so that its box of 0.8 m reaches into voxels that the box around the
// middle is clear of; one of them turns out to be occupied.
TEST_F(ExecutePathTest, LeavesWhereItStandsByTheMiddleOfItsVoxel) {
  const Lattice lattice = mapping_.grid().lattice();
  const auto key = [&](double x, double y, double z) {
    return VoxelKey{*lattice.key(x), *lattice.key(y), *lattice.key(z)};
  };
  const auto center = [&](double along) { return lattice.center(*lattice.key(along)); };
  const Pose beside{{1.05, 1.275, 1.25}, 0.0}, middle{{1.05, center(1.275), center(1.25)}, 0.0};
  static_cast<void>(mapping_.insert(scan_along({{1.05, 2.55, 1.35}, 0.0}, {0, -1, 0}, 1.69F)));
  ASSERT_EQ(mapping_.grid().at(key(1.05, 0.85, 1.35)), Occupancy::kOccupied);
  const Drive drive = [](std::size_t, const Pose& to) { return scan_along(to, {1, 0, 0}, 2.0F); };
  const auto travelled = [&](std::vector<Pose> path) {
    return execute(std::move(path), &body_, drive, mapping_).travelled;
  };
  EXPECT_EQ(travelled({beside, path_[1]}), 1U) << "past what is beside it";
  EXPECT_EQ(travelled({beside, middle, path_[1]}), 3U);
  EXPECT_EQ(travelled({beside, {{1.05, 1.29, 1.3}, 0.0}}), 1U) << "not far enough to be clear of it";
  EXPECT_EQ(travelled({beside, {{1.05, 1.21, 1.3}, 0.0}}), 1U) << "away from the middle";
}

TEST_F(ExecutePathTest, MeasuresAtEveryViewpointButTheFirst) {
  const VoxelGrid before = mapping_.grid();
  std::vector<Pose> asked;
  const Drive drive = [&](std::size_t robot, const Pose& to) {
    EXPECT_EQ(robot, 3U);
    asked.push_back(to);
    return scan_along(to, {0, 1, 0}, 2.5F);
  };
  const RobotStep step = execute(path_, &body_, drive, mapping_, 3);
  EXPECT_EQ(step.travelled, 5U);
  EXPECT_NEAR(step.length, 3.6, 1e-12);
  ASSERT_EQ(asked.size(), 4U);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    EXPECT_EQ(asked[i].position, path_[i + 1].position);
    EXPECT_EQ(asked[i].yaw, path_[i + 1].yaw);
  }
  // Free from the viewpoint at y = 1.35 to the hall's end at 3 was known; 3 to 3.85 and a hit there is new:
  // two free voxels and an occupied one, for each of the four columns.
  EXPECT_EQ(step.changed.size(), 12U);
  for (const VoxelChange& change : step.changed) {
    EXPECT_EQ(change.before, before.at(change.key));
    EXPECT_EQ(change.after, mapping_.grid().at(change.key));
    EXPECT_NE(change.before, change.after);
  }
}

TEST_F(ExecutePathTest, StopsWhereAScanShowsAnObstacle) {
  // From its second place it finds something 1.5 m ahead, so in the box around the fourth, 1.8 m ahead, and
  // also in that around the third but for the voxel between: the third is 0.9 m ahead, 0.4 wide.
  const auto run = [&](float distance, const BodyStencil* body) {
    Mapping mapping = hall();
    const Drive drive = [&](std::size_t, const Pose& to) {
      return to.position == path_[1].position ? scan_along(to, {1, 0, 0}, distance)
                                              : scan_along(to, {1, 0, 0}, kNothing);
    };
    return execute(path_, body, drive, mapping);
  };
  // x of the hit: 1.95 + distance. Boxes of 3 voxels around 2.85, 3.75 and 4.65 begin at 2.4, 3.3 and 4.2.
  EXPECT_EQ(run(2.5F, &body_).travelled, 4U);  // at 4.45: only the last is blocked
  EXPECT_EQ(run(1.5F, &body_).travelled, 3U);  // at 3.45
  EXPECT_EQ(run(0.6F, &body_).travelled, 2U);  // at 2.55
  EXPECT_NEAR(run(0.6F, &body_).length, 0.9, 1e-12);
  EXPECT_EQ(run(0.6F, nullptr).travelled, 5U) << "with no body the path is not checked";
}

// It does not come to the place that it was refused, turns to it from where it is, looks, and ends there.
TEST_F(ExecutePathTest, LooksAtWhatItCannotPass) {
  const Lattice& lattice = mapping_.grid().lattice();
  for (std::size_t refused = 1; refused < path_.size(); ++refused) {
    std::vector<Pose> planned = path_, asked;
    planned[1].position.y() += 0.6;  // so that not all segments have the same direction
    const Drive drive = [&](std::size_t, const Pose& to) -> std::optional<Scan> {
      asked.push_back(to);
      if (asked.size() == refused) return std::nullopt;
      return scan_along(to, {1, 0, 0}, kNothing);
    };
    const RobotStep step = execute(planned, &body_, drive, mapping_);
    ASSERT_EQ(asked.size(), refused + 1);
    EXPECT_EQ(step.travelled, refused + 1);
    EXPECT_EQ(reached_, refused) << "a look is none of its path";
    EXPECT_TRUE(step.changed.empty());
    const Pose &from = planned[refused - 1], &to = planned[refused];
    EXPECT_EQ(asked.back().position, from.position);
    const Eigen::Vector3d on = to.position - from.position;
    EXPECT_NEAR(asked.back().yaw, std::atan2(on.y(), on.x()), 1e-12);
    EXPECT_EQ(step.planned[refused].position, asked.back().position);
    EXPECT_EQ(step.planned[refused].yaw, asked.back().yaw);
    double length = 0.0;
    for (std::size_t i = 1; i < refused; ++i)
      length += (planned[i].position - planned[i - 1].position).norm();
    EXPECT_NEAR(step.length, length, 1e-12);
    // Blocked: what points on the segment lie in, but where it begins.
    const auto key_at = [&](const Eigen::Vector3d& at) { return lattice.key(at.cast<float>()).value(); };
    std::set<VoxelKey> expected;
    for (int part = 0; part <= 10'000; ++part) expected.insert(key_at(from.position + on * part / 10'000));
    expected.erase(key_at(from.position));
    const std::set<VoxelKey> blocked(step.blocked.begin(), step.blocked.end());
    EXPECT_TRUE(std::ranges::includes(blocked, expected)) << refused;
    EXPECT_TRUE(std::ranges::is_sorted(step.blocked));
    EXPECT_FALSE(blocked.contains(key_at(from.position)));
    EXPECT_LE(blocked.size(), expected.size() + 2) << "besides, such as it only touches";
  }
}

TEST_F(ExecutePathTest, EndsWithARobotThatNeitherGoesNorLooks) {
  for (std::size_t refused = 1; refused < path_.size(); ++refused) {
    std::size_t calls = 0;
    const Drive drive = [&](std::size_t, const Pose& to) -> std::optional<Scan> {
      if (++calls >= refused) return std::nullopt;
      return scan_along(to, {1, 0, 0}, kNothing);
    };
    const RobotStep step = execute(path_, &body_, drive, mapping_);
    EXPECT_EQ(calls, refused + 1);
    EXPECT_EQ(step.travelled, refused);
    EXPECT_EQ(reached_, refused);
    EXPECT_NEAR(step.length, 0.9 * static_cast<double>(refused - 1), 1e-12);
    EXPECT_FALSE(step.blocked.empty());
  }
}

TEST_F(ExecutePathTest, MarksFreeWhatIsKnown) {
  const VoxelGrid before = mapping_.grid();
  const std::vector<VoxelKey> known =
      test::keys_of(cube(*before.lattice().key(Eigen::Vector3d(5.85, 1, 1)), 3));
  RobotStep step;
  step.planned = {path_[0]};
  detail::execute_path(0, step, nullptr, {}, mapping_, known);
  std::vector<VoxelChange> expected;
  for (const VoxelKey& key : changed_keys(before, mapping_.grid()))
    expected.push_back({key, Occupancy::kUnknown, Occupancy::kFree});
  EXPECT_EQ(expected.size(), 18U) << "of 27 one layer was free";
  EXPECT_EQ(step.changed, expected);
}

TEST_F(ExecutePathTest, OfOnePlaceOrNoneMeasuresNothing) {
  const Drive drive = [&](std::size_t, const Pose&) -> std::optional<Scan> {
    ADD_FAILURE() << "asked to drive";
    return std::nullopt;
  };
  const RobotStep none = execute({}, &body_, drive, mapping_);
  EXPECT_EQ(none.travelled, 0U);
  EXPECT_EQ(none.length, 0.0);
  const RobotStep one = execute({path_[0]}, &body_, drive, mapping_);
  EXPECT_EQ(one.travelled, 1U);
  EXPECT_EQ(one.length, 0.0);
}

}  // namespace
}  // namespace frontlux::planner
