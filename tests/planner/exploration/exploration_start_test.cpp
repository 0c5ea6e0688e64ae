// What a robot takes for free around its start.

#include "support/complaint.hpp"
#include "support/test.hpp"

#include <frontlux/planner/exploration_start.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace frontlux::planner {
namespace {

const Lattice kLattice(0.1);

// All voxels near a start, and whether they have to be free by a plain look at their middles.
template <class IsFree>
void expect_free(const ExplorationStart& start, const IsFree& is_free) {
  const VoxelKey at = kLattice.key(start.pose.position).value();
  const std::set<VoxelKey> known(start.known_free.begin(), start.known_free.end());
  EXPECT_EQ(known.size(), start.known_free.size());
  std::size_t counted = 0;
  for_each_key(grown({at, at}, 30), [&](const VoxelKey& key) {
    const bool expected = is_free(kLattice.exact_center(key) - start.pose.position);
    ASSERT_EQ(known.contains(key), expected)
        << (kLattice.exact_center(key) - start.pose.position).transpose();
    counted += expected ? 1 : 0;
  });
  EXPECT_EQ(counted, known.size());
}

TEST(ExplorationStart, IsABallAroundABodyInSpace) {
  Robot robot = uav();
  robot.travel.extents = {0.5, 0.5, 0.3};
  const Pose pose{kLattice.exact_center({32780, 32790, 32775}), 0.3};
  const auto in_body = [](const Eigen::Vector3d& offset) {
    return std::abs(offset.x()) < 0.26 && std::abs(offset.y()) < 0.26 && std::abs(offset.z()) < 0.16;
  };
  expect_free(start_at(kLattice, robot, pose), in_body);
  expect_free(start_at(kLattice, robot, pose, 1.234),
              [&](const Eigen::Vector3d& offset) { return in_body(offset) || offset.norm() <= 1.234; });
  EXPECT_EQ(start_at(kLattice, robot, pose).pose.yaw, 0.3);
}

// The node is not around the body's middle: one of eight voxels along each axis, aligned.
TEST(ExplorationStart, IsANodeBesideABodyThatMovesThroughNodes) {
  Robot robot = uav();
  robot.travel.extents = {0.5, 0.5, 0.3};
  robot.travel.node_edge = 0.8;
  const VoxelKey at{32769, 32774, 32771};
  const Pose pose{kLattice.exact_center(at), 0.0};
  expect_free(start_at(kLattice, robot, pose), [&](const Eigen::Vector3d& offset) {
    const bool in_body =
        std::abs(offset.x()) < 0.26 && std::abs(offset.y()) < 0.26 && std::abs(offset.z()) < 0.16;
    const Eigen::Vector3d place = pose.position + offset;  // the node reaches from 0 to 0.8 m
    return in_body || (place.minCoeff() > 0.0 && place.maxCoeff() < 0.8);
  });
}

// The body is 0.7 m high, and the sensor in the middle of the voxel that is number 7 from the floor up.
TEST(ExplorationStart, IsADiscFromTheFloorToTheSensorOfARobotThatDrives) {
  Robot robot = ugv();
  robot.travel.extents = {0.5, 0.5, 0.7};
  robot.travel.sensor_height = 0.75;
  const Pose pose{kLattice.exact_center({32780, 32790, 32775}), 0.0};
  const auto is_free = [](const Eigen::Vector3d& offset) {
    const bool high = offset.z() < 0.01 && offset.z() > -0.76;
    const bool body = std::abs(offset.x()) < 0.26 && std::abs(offset.y()) < 0.26;
    return high && (body || std::hypot(offset.x(), offset.y()) <= 2.05);
  };
  expect_free(start_at(kLattice, robot, pose, 2.05), is_free);
}

TEST(ExplorationStart, RefusesWhatIsNoStart) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Robot robot = uav();
  const Pose pose{{1.0, 1.0, 1.0}, 0.0};
  EXPECT_REFUSED(start_at(kLattice, robot, {{nan, 0.0, 0.0}, 0.0}));
  EXPECT_REFUSED(start_at(kLattice, robot, {{0.0, 0.0, 0.0}, nan}));
  EXPECT_REFUSED(start_at(kLattice, robot, {{1e9, 0.0, 0.0}, 0.0}));
  for (const double radius : {-0.1, nan, 101.0}) EXPECT_REFUSED(start_at(kLattice, robot, pose, radius));
  test::expect_complaint([&] { static_cast<void>(start_at(kLattice, robot, pose, 90.0)); }, {"2^24"});
}

}  // namespace
}  // namespace frontlux::planner
