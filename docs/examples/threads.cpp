// One thread inserts scans while another one casts, never waits for it, and is told what is new: threads
// MAP.bt
#include <frontlux/frontier_set.hpp>
#include <frontlux/live_map.hpp>
#include <frontlux/sensor_rays.hpp>

#include <octomap/OcTree.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

using namespace frontlux;

// A MapChange is a view, valid until the next update. This holds what it shows; a grid's copy costs one
// pointer.
struct Change {
  VoxelGrid grid;
  std::vector<VoxelKey> keys;
};

int main(int argc, char** arguments) try {
  if (argc != 2) throw std::invalid_argument("usage: threads MAP.bt");
  const OctreeRayCaster world(read_octree(arguments[1]));  // what the lidar sees
  const auto directions = sensor_directions({FieldOfView::Shape::kSpinning, 0.0, 0.6, 12.0}, 720, 32);
  octomap::OcTree tree(0.1);
  LiveMap map(tree);
  FrontierSet frontiers(map.grid(), kAllVoxels);
  std::atomic<bool> sensing = true;
  std::mutex mutex;
  std::vector<Change> changes;  // that the other thread has not taken yet

  // The map belongs to this thread: it alone changes the tree and calls update.
  std::thread sensor([&] {
    for (int scan = 0; scan < 10; ++scan) {
      const Eigen::Vector3d at(2.0 + 0.7 * scan, 2.0, 1.0);
      std::vector<Hit> hits(directions.size());
      world.castRays(rays_from(Eigen::Isometry3d(Eigen::Translation3d(at)), directions, 12.0), hits, true);
      tree.insertPointCloud(to_pointcloud(hits), to_octomap(at.cast<float>()));
      const MapChange change = map.update();
      const std::lock_guard lock(mutex);
      changes.push_back({change.grid, {change.keys.begin(), change.keys.end()}});
    }
    sensing = false;
  });

  // This one casts meanwhile, on one core: each batch is answered from the map as it was when it began.
  const auto take_changes = [&] {
    const std::vector<Change> taken = [&] {
      const std::lock_guard lock(mutex);
      return std::exchange(changes, {});
    }();
    for (const Change& change : taken) frontiers.update({change.grid, change.keys});  // all, in their order
  };
  const RayCaster& caster = map.caster();
  const auto rays = rays_from(Eigen::Isometry3d(Eigen::Translation3d(2.0, 2.0, 1.0)), directions);
  std::vector<Hit> hits(rays.size());
  tbb::task_arena one_core(1);
  std::size_t batches = 0;
  do {
    one_core.execute([&] { caster.cast(rays, hits, UnknownPolicy::kBlock); });
    take_changes();
    ++batches;
  } while (sensing);
  sensor.join();
  take_changes();

  caster.cast(rays, hits, UnknownPolicy::kBlock);
  std::cout << batches << " batches meanwhile; now " << std::ranges::count_if(hits, &Hit::occupied) << " of "
            << hits.size() << " rays hit something, and there are " << frontiers.size() << " frontiers\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
