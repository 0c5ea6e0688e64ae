#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/exploration_start.hpp>
#include <frontlux/planner/mapping.hpp>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace frontlux::planner {

ExplorationStart start_at(const Lattice& lattice, const Robot& robot, const Pose& pose, double free_radius) {
  constexpr double kWidest = 100.0;  // [m]
  constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 24;
  const Eigen::Vector3d& at = pose.position;
  const auto sensor = lattice.key(at);
  if (!sensor || !std::isfinite(pose.yaw))
    throw std::invalid_argument("start: the pose, " + std::to_string(at.x()) + ", " + std::to_string(at.y()) +
                                ", " + std::to_string(at.z()) + " m and " + std::to_string(pose.yaw) +
                                " rad, is not finite or outside the key range");
  if (!(free_radius >= 0.0 && free_radius <= kWidest))
    throw std::invalid_argument("start: free_radius is " + std::to_string(free_radius) +
                                " m, but has to be 0 to 100 m");
  TravelOptions by_voxels = robot.travel;
  by_voxels.node_edge = 0.0;
  const BodyStencil stencil(by_voxels, lattice.resolution());
  const KeyBox body = stencil.box_around(*sensor);
  // Of a robot on nodes the node, else the same as the body.
  const KeyBox cell = voxels_of_cell(robot.travel, lattice, cell_of(robot.travel, lattice, *sensor));
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(free_radius);
  KeyBox box = hull(body, cell);
  if (free_radius > 0.0) box = hull(box, voxels_of(lattice, {at - reach, at + reach}));
  if (size_of(box) > kMostVoxels)
    throw std::invalid_argument("start: free_radius and body reach over " + std::to_string(size_of(box)) +
                                " voxels, but there may be at most 2^24: give a smaller radius");
  const auto is_near = [&](const VoxelKey& voxel) {
    const Eigen::Vector3d offset = lattice.exact_center(voxel) - at;
    if (!robot.travel.drives()) return offset.norm() <= free_radius;
    return offset.head<2>().norm() <= free_radius && body.min.z <= voxel.z && voxel.z <= sensor->z;
  };
  ExplorationStart start{pose, {}};
  for_each_key(box, [&](const VoxelKey& voxel) {
    const bool in_node = robot.travel.node_edge > 0.0 && cell.contains(voxel);
    if (stencil.contains(*sensor, voxel) || in_node || is_near(voxel)) start.known_free.push_back(voxel);
  });
  return start;
}

}  // namespace frontlux::planner
