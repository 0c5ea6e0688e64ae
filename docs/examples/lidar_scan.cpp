// What a lidar of 32 beams sees from a pose in a map: lidar_scan MAP.bt X Y Z YAW
#include <frontlux/octomap.hpp>
#include <frontlux/sensor_rays.hpp>

#include <octomap/OcTree.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>

using namespace frontlux;

int main(int argc, char** arguments) try {
  if (argc != 6) throw std::invalid_argument("usage: lidar_scan MAP.bt X Y Z YAW");
  const VoxelGrid grid = make_voxel_grid(read_octree(arguments[1]));
  const auto caster = make_ray_caster(grid);
  const auto number = [&](int i) { return std::stod(arguments[i]); };

  const FieldOfView lidar{FieldOfView::Shape::kSpinning, 0.0, 0.7, 12.0};  // 0.7 rad high, 12 m far
  const auto directions = sensor_directions(lidar, 720, 32);               // row by row from the top
  const Eigen::Isometry3d T_map_sensor = Eigen::Translation3d(number(2), number(3), number(4)) *
                                         Eigen::AngleAxisd(number(5), Eigen::Vector3d::UnitZ());
  const std::vector<Ray> rays = rays_from(T_map_sensor, directions, lidar.max_range);
  std::vector<Hit> hits(rays.size());
  caster->cast(rays, hits, UnknownPolicy::kPass);
  const auto returns = std::ranges::count_if(hits, &Hit::occupied);
  const octomap::Pointcloud scan = to_pointcloud(hits);  // as OctoMap's insertPointCloud takes it

  std::vector<VoxelKey> seen;
  for (const Hit& hit : hits)
    if (hit.occupied()) seen.push_back(hit.key);
  std::ranges::sort(seen);
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  std::cout << returns << " of " << rays.size() << " rays return, " << scan.size() << " points in "
            << seen.size() << " voxels\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
