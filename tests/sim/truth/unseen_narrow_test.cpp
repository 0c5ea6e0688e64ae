// By how much robots are too large for what is behind an opening, against the free voxels in the opening.
#include "sim/mesh/box_mesh.hpp"

#include <frontlux/sim/unseen.hpp>

#include <cmath>

namespace frontlux::sim {
namespace {

using Eigen::Vector3d, Eigen::Vector3f;
using planner::BodyShape, planner::Robot;

constexpr double kResolution = 0.1;
const planner::Pose kStart{{1.25, 1.15, 1.25}, 0.0};

// In a wall between two rooms [m].
struct Opening {
  float left, right, low, high;
};
constexpr Opening kDoor{0.85F, 1.45F, 0.05F, 2.55F};  // 0.6 m wide, as high as the rooms

// Two rooms of 2.4 x 2.2 x 2.5 m, and a wall between them that is a metre thick: from before an opening in it
// robots see little of the room behind.
World two_rooms(const Opening& at) {
  World world{"two rooms", {}, {Vector3d(0, 0, 0), Vector3d(6, 2.4, 2.7)}, std::nullopt};
  test::add_box(world.mesh, {Vector3f(0.05F, 0.05F, 0.05F), Vector3f(5.85F, 2.25F, 2.55F)});
  const auto add_wall = [&](float left, float right, float low, float high) {
    if (left < right && low < high)
      test::add_box(world.mesh, {Vector3f(2.45F, left, low), Vector3f(3.45F, right, high)});
  };
  add_wall(0.05F, at.left, 0.05F, 2.55F);
  add_wall(at.right, 2.25F, 0.05F, 2.55F);
  add_wall(at.left, at.right, 0.05F, at.low);
  add_wall(at.left, at.right, at.high, 2.55F);
  return world;
}

GroundTruth truth_of(const Opening& opening) { return {two_rooms(opening), kResolution, kStart.position}; }

// A robot in space that sees all around and as far as the rooms are long.
Robot flying(double width, BodyShape shape = BodyShape::kBox) {
  Robot robot = planner::uav();
  robot.travel.shape = shape;
  robot.travel.extents.setConstant(width);
  robot.travel.min_height = width / 2;
  return robot;
}

// The same on wheels, with its sensor 0.75 m above the floor.
Robot driving(double width, BodyShape shape = BodyShape::kBox) {
  Robot robot = flying(width, shape);
  robot.travel.motion = planner::Motion::kPlane;
  robot.travel.extents.z() = shape == BodyShape::kSphere ? width : 0.8;
  robot.travel.ground_extents = Eigen::Vector2d::Constant(width - 0.1);
  return robot;
}

planner::Pose start_of(const Robot& robot) {
  planner::Pose start = kStart;
  if (robot.travel.drives()) start.position.z() = kResolution + robot.travel.sensor_height;
  return start;
}

Unseen explain(const GroundTruth& truth, const std::vector<Robot>& robots) {
  std::vector<planner::Pose> starts;
  for (const Robot& robot : robots) starts.push_back(start_of(robot));
  return explain_unseen(truth, VoxelGrid(kResolution), robots, starts);
}

// [m] The least reduction, in steps of 0.05 m, with which an odd number of voxels covers a width, and no more
// than this many.
double reduction(double width, int voxels) {
  const double room = (voxels - (voxels % 2 == 0 ? 1 : 0)) * kResolution;
  return std::ceil((width - room) / 0.05 - 1e-6) * 0.05;
}

// Free voxels in the middle of the wall, along y or z through the point.
int free_voxels(const GroundTruth& truth, const Vector3d& point, int axis) {
  int count = 0;
  for (Vector3d at(2.95, axis == 1 ? 0.05 : point.y(), axis == 2 ? 0.05 : point.z()); at[axis] < 3.3;
       at[axis] += kResolution)
    if (const auto key = truth.lattice().key(at)) count += truth.at(*key) == Truth::kFree ? 1 : 0;
  return count;
}

TEST(UnseenNarrow, TellsByHowMuchBodiesAreTooWideForADoor) {
  const GroundTruth truth = truth_of(kDoor);
  const int room = free_voxels(truth, kStart.position, 1);
  ASSERT_EQ(room, 5) << "of 0.6 m the walls' surfaces take half a voxel on either side";
  for (const Robot& robot : {flying(0.9), flying(0.62), flying(0.9, BodyShape::kSphere),
                             driving(0.9, BodyShape::kCylinder), driving(0.9, BodyShape::kSphere)}) {
    SCOPED_TRACE(std::string(name_of(robot.travel.shape)) + ", " + std::to_string(robot.travel.extents.x()) +
                 " m, " + std::string(name_of(robot.travel.motion)));
    const Unseen unseen = explain(truth, {robot});
    EXPECT_GT(unseen.narrow, 0.1) << "the other room";
    ASSERT_EQ(unseen.robots.size(), 1U);
    ASSERT_TRUE(unseen.robots[0].narrow_by.has_value());
    EXPECT_NEAR(*unseen.robots[0].narrow_by, reduction(robot.travel.extents.x(), room), 1e-9);
    EXPECT_GT(unseen.robots[0].in_view_then, 0.5 * unseen.narrow);
    EXPECT_LE(unseen.robots[0].in_view_then, unseen.narrow);
    EXPECT_LT(unseen.robots[0].without_min_height, 0.1 * unseen.narrow);
  }
}

// What is told is the body's part: margins stay, on both sides.
TEST(UnseenNarrow, LeavesMarginsAsTheyAre) {
  const GroundTruth truth = truth_of(kDoor);
  for (const double margin : {0.05, 0.1}) {
    Robot robot = flying(0.9);
    robot.travel.margin = margin;
    const Unseen unseen = explain(truth, {robot});
    EXPECT_NEAR(unseen.robots.at(0).narrow_by.value_or(0.0), reduction(0.9 + 2 * margin, 5), 1e-9) << margin;
  }
  Robot robot = flying(0.3);
  robot.travel.margin = 0.25;  // no body is left between 0.5 m of margins
  const Unseen unseen = explain(truth, {robot});
  EXPECT_GT(unseen.narrow, 0.1);
  EXPECT_FALSE(unseen.robots.at(0).narrow_by.has_value());
  EXPECT_EQ(unseen.robots.at(0).in_view_then, 0.0);
}

// A body that is less high gets as near to the floor with its lower face as before, and no nearer.
TEST(UnseenNarrow, CountsTheHeightOfBodiesInSpace) {
  const GroundTruth truth = truth_of({0.55F, 1.75F, 0.05F, 0.65F});
  const int room = free_voxels(truth, {0.0, 1.15, 0.35}, 2);
  ASSERT_EQ(room, 5);
  const Unseen unseen = explain(truth, {flying(0.9)});
  EXPECT_NEAR(unseen.robots.at(0).narrow_by.value_or(0.0), reduction(0.9, room), 1e-9);
  Robot high = flying(0.5);
  high.travel.min_height = 1.2;
  const Unseen kept_high = explain(truth, {high});
  EXPECT_GT(kept_high.narrow, 0.2);
  EXPECT_FALSE(kept_high.robots.at(0).narrow_by.has_value());
  EXPECT_GT(kept_high.robots.at(0).without_min_height, 0.9 * kept_high.narrow) << "it fits through";
}

TEST(UnseenNarrow, JudgesEachRobotAlone) {
  // A hatch above what drives, or sees through it from its plane.
  const GroundTruth truth = truth_of({0.85F, 1.45F, 1.65F, 2.55F});
  const Unseen unseen = explain(truth, {driving(0.5), flying(0.9), flying(0.7)});
  ASSERT_EQ(unseen.robots.size(), 3U);
  EXPECT_FALSE(unseen.robots[0].narrow_by.has_value()) << "however small, it stays on the floor";
  EXPECT_NEAR(unseen.robots[1].narrow_by.value_or(0.0), reduction(0.9, 5), 1e-9);
  EXPECT_NEAR(unseen.robots[2].narrow_by.value_or(0.0), reduction(0.7, 5), 1e-9);
  EXPECT_TRUE(explain(truth, {driving(0.5), flying(0.5)}).robots.empty()) << "one of them fits";
}

// Cells are aligned nodes of four voxels then, or of two: of the five free ones four are not one node.
TEST(UnseenNarrow, MakesNodesSmaller) {
  Robot robot = flying(0.3);
  robot.travel.node_edge = 0.4;
  const Unseen unseen = explain(truth_of(kDoor), {robot});
  EXPECT_NEAR(unseen.robots.at(0).narrow_by.value_or(0.0), 0.2, 1e-9);
}

TEST(UnseenNarrow, IsNotAskedWhereLittleIsNarrow) {
  const GroundTruth truth = truth_of(kDoor);
  const Unseen unseen = explain(truth, {flying(0.5)});
  EXPECT_GT(unseen.in_view, 0.97);
  EXPECT_LT(unseen.narrow, kMuchUnseen);
  EXPECT_TRUE(unseen.robots.empty());
}

}  // namespace
}  // namespace frontlux::sim
