// What the ROS 2 example does without ROS, in a room whose lidar is our caster.

#include "explorer.hpp"

#include "support/complaint.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/sensor_rays.hpp>

#include <octomap/OcTree.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace frontlux {
namespace {

using planner::Pose;
using Waypoints = std::vector<Explorer::Waypoint>;

Eigen::Isometry3d matrix_of(const Pose& pose) {
  return Eigen::Translation3d(pose.position) * Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ());
}

// Straight from waypoint to waypoint.
Pose follow(const Waypoints& path, double time) {
  if (time <= path.front().time) return path.front().pose;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const auto& [begin, from] = path[i - 1];
    const auto& [end, to] = path[i];
    if (time > end) continue;
    const double part = (time - begin) / (end - begin);
    return {from.position + part * (to.position - from.position), from.yaw + part * (to.yaw - from.yaw)};
  }
  return path.back().pose;
}

class RosExplorer : public testing::Test {
 protected:
  RosExplorer() {
    description_.robot.travel.extents = {0.6, 0.6, 0.4};
    options_.robot = description_.robot;
  }

  // A lidar driver's cloud, in the sensor's frame.
  [[nodiscard]] std::vector<Eigen::Vector3f> cloud(const Pose& pose) const {
    const auto directions = sensor_directions(description_.robot.view, 60, 45);
    const double max_range = description_.robot.view.max_range;
    const auto rays = rays_from(matrix_of(pose), directions, max_range);
    std::vector<Hit> hits(rays.size());
    caster_->cast(rays, hits, UnknownPolicy::kPass);
    std::vector<Eigen::Vector3f> points;
    for (std::size_t i = 0; i < hits.size(); ++i)
      points.push_back(directions[i].cast<float>() *
                       (hits[i].occupied() ? hits[i].distance : 2.0F * static_cast<float>(max_range)));
    return points;
  }

  // A scan from a pose, in the sensor's own frame.
  std::optional<Waypoints> insert(Explorer& explorer, double time, const Pose& pose) const {
    return explorer.insert(time, matrix_of(pose), matrix_of(pose), cloud(pose));
  }

  VoxelGrid room_ =
      make_voxel_grid(read_octree(std::filesystem::path(FRONTLUX_DATA_DIR) / "maps/room_0.1m.bt"));
  std::unique_ptr<RayCaster> caster_ = make_ray_caster(room_);
  planner::RobotDescription description_ = planner::uav_description();
  Explorer::Options options_;
  Pose start_{{8.45, 8.35, 1.65}, 0.0};
};

TEST_F(RosExplorer, ExploresARoomByCloudsAndWaypoints) {
  Explorer explorer(options_);
  EXPECT_EQ(explorer.tree(), nullptr);
  Waypoints now = {{0.0, start_}}, next = now;
  int answers = 0;
  double time = 0.0;
  for (; !explorer.end() && time < 600.0; time += 0.25) {
    const Pose pose = follow(time >= next.front().time ? next : now, time);
    const auto answer = insert(explorer, time, pose);
    if (!answer) continue;
    ++answers;
    if (time >= next.front().time) now = next;
    next = *answer;
    // It begins in the future, where the robot will be then.
    EXPECT_GE(next.front().time, time);
    EXPECT_LT((follow(now, next.front().time).position - next.front().pose.position).norm(), 0.05);
  }
  EXPECT_LT(time, 600.0);
  EXPECT_GT(answers, 10);
  ASSERT_TRUE(explorer.end());
  EXPECT_NE(explorer.end()->find("frontiers"), std::string::npos);
  const VoxelGrid map = make_voxel_grid(*explorer.tree());
  std::size_t known = 0;
  const auto free = keys_in(room_, Occupancy::kFree);
  for (const VoxelKey& key : free)
    known += map.at(*map.lattice().key(room_.lattice().center(key))) != Occupancy::kUnknown ? 1 : 0;
  EXPECT_GT(static_cast<double>(known) / static_cast<double>(free.size()), 0.95);
}

TEST_F(RosExplorer, TakesCloudsThatComeLateAndRobotsThatStop) {
  Explorer explorer(options_);
  EXPECT_REFUSED(explorer.stopped(0.0, matrix_of(start_)));
  EXPECT_TRUE(insert(explorer, 5.0, start_));
  const auto size = explorer.tree()->size();
  const Pose turned{start_.position, 2.0};
  EXPECT_FALSE(insert(explorer, 4.9, turned));
  EXPECT_GT(explorer.tree()->size(), size);
  explorer.stopped(6.0, matrix_of(start_));
  const auto answer = insert(explorer, 6.1, start_);
  ASSERT_TRUE(answer);
  EXPECT_LT((answer->front().pose.position - start_.position).norm(), 1e-9);
}

// The robot has been carried a little: it goes on from there, with the cell that it is in.
TEST_F(RosExplorer, PlansFromWhereARobotIsDisplacedTo) {
  Explorer explorer(options_);
  const Pose aside{start_.position + Eigen::Vector3d(0.05, -0.05, 0.0), 0.4};
  EXPECT_REFUSED(explorer.displaced(0.0, matrix_of(aside)));
  EXPECT_TRUE(insert(explorer, 5.0, start_));
  explorer.displaced(6.0, matrix_of(aside));
  const auto answer = insert(explorer, 6.1, aside);
  ASSERT_TRUE(answer);
  EXPECT_LT((answer->front().pose.position - aside.position).norm(), 1e-9);
  EXPECT_GT((answer->back().pose.position - aside.position).norm(), 0.1);
}

// A camera's driver names its optical frame: x right, y down, z forward. The yaw is that of the sensor's.
TEST_F(RosExplorer, TakesCloudsInAnOpticalFrame) {
  Eigen::Isometry3d T_sensor_optical = Eigen::Isometry3d::Identity();
  T_sensor_optical.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  std::vector<Eigen::Vector3f> optical = cloud(start_);
  for (Eigen::Vector3f& point : optical) point = Eigen::Vector3f(-point.y(), -point.z(), point.x());
  Explorer explorer(options_), same(options_);
  const auto answer = explorer.insert(5.0, matrix_of(start_), matrix_of(start_) * T_sensor_optical, optical);
  const auto expected = insert(same, 5.0, start_);
  ASSERT_TRUE(answer && expected);
  EXPECT_EQ(answer->front().pose.yaw, start_.yaw);
  EXPECT_EQ(make_voxel_grid(*explorer.tree()), make_voxel_grid(*same.tree()));
  EXPECT_EQ(answer->back().pose.position, expected->back().pose.position);
}

TEST_F(RosExplorer, RefusesWhatIsNoScan) {
  Explorer explorer(options_);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto here = matrix_of(start_), far = matrix_of({{1e9, 0.0, 0.0}, 0.0});
  EXPECT_REFUSED(explorer.insert(kNan, here, here, {}));
  EXPECT_REFUSED(explorer.insert(0.0, far, far, {}));
  EXPECT_EQ(explorer.tree(), nullptr);
  explorer.insert(0.0, here, here, std::vector<Eigen::Vector3f>{{NAN, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}});
  for (const double wrong : {0.0, -1.0, kNan}) {
    Explorer::Options options = options_;
    options.resolution = wrong;
    EXPECT_REFUSED(Explorer(options));
    options = options_;
    options.reach.z() = wrong;
    EXPECT_REFUSED(Explorer(options));
  }
}

}  // namespace
}  // namespace frontlux
