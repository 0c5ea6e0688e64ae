// castRay replaced, one by one and in a batch, in a map that grows; compared with OctoMap's: drop_in MAP.bt
#include <frontlux/octomap.hpp>

#include <octomap/OcTree.h>

#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

// castRay's arguments in their order, answered by any caster, as that of a LiveMap.
static bool cast_ray(const frontlux::RayCaster& caster, const octomap::point3d& origin,
                     const octomap::point3d& direction, octomap::point3d& end, bool ignore_unknown = false,
                     double max_range = -1.0) {
  const auto unknown = ignore_unknown ? frontlux::UnknownPolicy::kPass : frontlux::UnknownPolicy::kBlock;
  const frontlux::Hit hit =
      caster.cast({frontlux::from_octomap(origin), frontlux::from_octomap(direction), max_range}, unknown);
  if (hit.stop != frontlux::RayStop::kInvalid) end = frontlux::to_octomap(hit.end);
  return hit.occupied();
}

int main(int argc, char** arguments) try {
  if (argc != 2) throw std::invalid_argument("usage: drop_in MAP.bt");
  octomap::OcTree tree(arguments[1]);  // nothing is in it if there is no such file
  if (tree.size() == 0) throw std::runtime_error(std::string(arguments[1]) + " is no .bt file with a map");
  const octomap::point3d origin(2.0F, 2.0F, 1.0F), direction(1.0F, 0.7F, 0.1F), sensor(5.0F, 5.0F, 1.5F);
  octomap::point3d end, theirs, ours;
  octomap::Pointcloud scan;
  scan.push_back(5.0F, 3.0F, 1.5F);
  std::vector<frontlux::Ray> rays;
  for (int i = -500; i < 500; ++i)
    rays.push_back({{2.0F, 2.0F, 1.0F}, {1.0F, 0.01F * static_cast<float>(i), 0.1F}, 30.0});
  std::vector<frontlux::Hit> hits(rays.size());

  const bool their_hit = tree.castRay(origin, direction, theirs, true, 30.0);

  frontlux::OctreeRayCaster fast(tree);                               // of an octomap::OcTree or ColorOcTree
  const bool hit = fast.castRay(origin, direction, end, true, 30.0);  // OctoMap's signature and its answer
  fast.castRays(rays, hits, true);                                    // many rays on all cores
  tree.insertPointCloud(scan, sensor);
  fast.refresh();  // from here on, casts see the new map

  fast.castRays(rays, hits, true);
  std::size_t same = hit == their_hit && end == theirs ? 1 : 0;
  const bool now = tree.castRay(origin, direction, theirs, true, 30.0);
  same += cast_ray(fast.caster(), origin, direction, ours, true, 30.0) == now && ours == theirs ? 1 : 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const octomap::point3d along(rays[i].direction.x(), rays[i].direction.y(), rays[i].direction.z());
    const bool theirs_hit = tree.castRay(origin, along, theirs, true, 30.0);
    const bool same_end = frontlux::to_octomap(hits[i].key) == tree.coordToKey(theirs);
    same += hits[i].occupied() == theirs_hit && same_end ? 1 : 0;
  }
  std::cout << same << " of " << rays.size() + 2 << " answers are castRay's\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
