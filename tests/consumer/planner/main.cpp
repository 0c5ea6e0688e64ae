// A robot with a depth camera explores a room: consumer ROOM.bt. What it measures are casts into that map.

#include <frontlux/octomap.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/information_gain.hpp>
#include <frontlux/sensor_rays.hpp>

#include <octomap/OcTree.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <vector>

using namespace frontlux;
using namespace frontlux::planner;

int main(int, char** arguments) {
  const VoxelGrid room = make_voxel_grid(read_octree(arguments[1]));
  const auto caster = make_ray_caster(room);
  const RobotDescription uav = uav_description();
  const double max_range = uav.robot.view.max_range;
  const auto directions = sensor_directions(uav.robot.view, uav.columns, uav.rows);
  const Drive drive = [&](std::size_t, const Pose& pose) {
    const Eigen::Isometry3d T_map_sensor =
        Eigen::Translation3d(pose.position) * Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ());
    const std::vector<Ray> rays = rays_from(T_map_sensor, directions, max_range);
    std::vector<Hit> hits(rays.size());
    caster->cast(rays, hits, UnknownPolicy::kPass);
    Scan scan{pose.position.cast<float>(), max_range, {}, {}};
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool seen = hits[i].occupied() && hits[i].distance <= max_range;
      scan.directions.push_back(rays[i].direction);
      scan.ranges.push_back(seen ? hits[i].distance : std::numeric_limits<float>::infinity());
    }
    return scan;
  };

  const Lattice lattice = room.lattice();
  const KeyBox walls = bounds_of(keys_in(room, Occupancy::kOccupied));
  const Eigen::AlignedBox3d bounds(room.lattice().exact_center(walls.min),
                                   room.lattice().exact_center(walls.max));
  ExplorationOptions options = exploration_options();
  options.team.push_back({uav.robot, goal_options(uav.robot)});
  Exploration exploration(
      options, Mapping({.resolution = lattice.resolution(), .bounds = voxels_of(lattice, bounds)}));
  ExplorationStart start{{{8.45, 8.35, 1.65}, 0.0}, {}};
  const Eigen::Vector3d body = Eigen::Vector3d::Constant(0.5);
  for_each_key(voxels_of(lattice, {start.pose.position - body, start.pose.position + body}),
               [&](const VoxelKey& key) { start.known_free.push_back(key); });
  exploration.begin({&start, 1}, drive);
  while (!exploration.end()) exploration.step(drive);

  // What holds Eigen's arrays is moved and destroyed here, but was made in the library.
  const Pose pose{{0.0, 0.0, 1.0}, 0.0};
  const Eigen::Vector3d ahead(1.0, 0.0, 1.0);
  const VisiblePair pair{0, 0};
  const VisiblePairs pairs(1, 1, {&pair, 1});
  const double yaw = 0.0;
  InformationGain gain({&pose, 1}, {&ahead, 1}, pairs, uav.robot.view);
  const InformationGain copy = gain;
  gain = InformationGain({&pose, 1}, {&ahead, 1}, pairs, uav.robot.view);
  if (gain.distinct({&yaw, 1}) != 1 || copy.distinct({&yaw, 1}) != 1) return 1;

  const std::vector<VoxelKey> there = keys_in(room, Occupancy::kFree);
  const auto found = std::ranges::count_if(
      there, [&](const VoxelKey& key) { return exploration.mapping().grid().at(key) == Occupancy::kFree; });
  std::printf("%td of %zu free voxels explored, since %s\n", found, there.size(),
              describe(*exploration.end(), options).c_str());
  return static_cast<double>(found) > 0.98 * static_cast<double>(there.size()) ? 0 : 1;
}
