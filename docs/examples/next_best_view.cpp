// Six lidar scans of WORLD, each from the best of 1,000 viewpoints in the map so far: next_best_view WORLD.bt
#include <frontlux/frontier_set.hpp>
#include <frontlux/live_map.hpp>
#include <frontlux/sensor_rays.hpp>
#include <frontlux/view_quality.hpp>

#include <octomap/OcTree.h>

#include <iostream>
#include <stdexcept>

using namespace frontlux;

int main(int argc, char** arguments) try {
  if (argc != 2) throw std::invalid_argument("usage: next_best_view WORLD.bt");
  const OctreeRayCaster world(read_octree(arguments[1]));  // what the lidar sees
  const FieldOfView lidar{FieldOfView::Shape::kSpinning, 0.0, 0.6, 12.0};
  const auto directions = sensor_directions(lidar, 720, 32);
  octomap::OcTree tree(0.1);
  LiveMap map(tree);
  FrontierSet frontiers(map.grid(), kAllVoxels);
  ViewQualityImage image(map.grid().lattice(), lidar, {});
  Eigen::Vector3d sensor(2.0, 2.0, 1.0);
  for (int scan = 1; scan <= 6; ++scan) {
    std::vector<Hit> hits(directions.size());
    world.castRays(rays_from(Eigen::Isometry3d(Eigen::Translation3d(sensor)), directions, 12.0), hits, true);
    tree.insertPointCloud(to_pointcloud(hits), to_octomap(sensor.cast<float>()));
    const MapChange change = map.update();
    frontiers.update(change);
    std::vector<VoxelKey> free = keys_in(map.grid(), Occupancy::kFree), viewpoints;
    for (std::size_t i = 0; i < 1000; ++i) viewpoints.push_back(free[i * free.size() / 1000]);
    image.update(map.caster(), viewpoints, frontiers.keys(), change);
    sensor = map.grid().lattice().exact_center(viewpoints[image.best()]);
    std::cout << "scan " << scan << ": " << free.size() << " voxels free, " << frontiers.size()
              << " frontiers\n";
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
