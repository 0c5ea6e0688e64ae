// A robot with a depth camera explores an empty room of 8 x 6 x 3 m, whose walls it sees by a formula.

#include <frontlux/io/robot_file.hpp>
#include <frontlux/planner/exploration.hpp>

#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace {

namespace planner = frontlux::planner;

const Eigen::AlignedBox3d kRoom(Eigen::Vector3d(-4.0, -3.0, 0.1), Eigen::Vector3d(4.0, 3.0, 3.1));

// What the camera measures: the distance from a point in the room to its walls, along rays in view.
planner::Scan scan_from(const planner::Pose& pose, const planner::RobotDescription& camera) {
  planner::Scan scan{pose.position.cast<float>(), camera.robot.view.max_range, {}, {}};
  for (int column = 0; column < 160; ++column)
    for (int row = 0; row < 120; ++row) {
      const double left = (2.0 * column / 159.0 - 1.0) * std::tan(camera.robot.view.horizontal / 2.0),
                   up = (2.0 * row / 119.0 - 1.0) * std::tan(camera.robot.view.vertical / 2.0);
      const Eigen::Vector3d ahead =
          Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(1.0, left, up).normalized();
      double range = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        const double wall = ahead[axis] < 0.0 ? kRoom.min()[axis] : kRoom.max()[axis];
        if (ahead[axis] != 0.0) range = std::fmin(range, (wall - pose.position[axis]) / ahead[axis]);
      }
      scan.directions.emplace_back(ahead.cast<float>());
      scan.ranges.push_back(range + 1e-3 < scan.max_range ? static_cast<float>(range + 1e-3)
                                                          : std::numeric_limits<float>::infinity());
    }
  return scan;
}

}  // namespace

int main() {
  const planner::RobotDescription uav = planner::uav_description();
  const frontlux::Lattice lattice(0.3);
  const planner::Pose start{{0.15, 0.15, 1.65}, 0.0};
  const Eigen::Vector3d body = Eigen::Vector3d::Constant(0.45);

  planner::ExplorationOptions options = planner::exploration_options();
  options.team.push_back({uav.robot, planner::goal_options(uav.robot)});
  planner::Exploration exploration(
      options, planner::Mapping({.resolution = 0.3, .bounds = planner::voxels_of(lattice, kRoom)}));
  const planner::Drive drive = [&](std::size_t, const planner::Pose& pose) { return scan_from(pose, uav); };
  planner::ExplorationStart begin{start, {}};
  for_each_key(planner::voxels_of(lattice, {start.position - body, start.position + body}),
               [&](const frontlux::VoxelKey& key) { begin.known_free.push_back(key); });
  exploration.begin({&begin, 1}, drive);
  while (!exploration.end() && exploration.frontiers().size() > 20) exploration.step(drive);
  const auto count = exploration.mapping().grid().count();
  std::printf("%llu free voxels, %zu frontiers left\n", static_cast<unsigned long long>(count[1]),
              exploration.frontiers().size());
  return count[1] > 4000 ? 0 : 1;  // of 5,000 or so
}
