#include "planner/planner_scene.hpp"

#include "random.hpp"

#include <frontlux/planner/travel_corridor.hpp>

#include <algorithm>
#include <stdexcept>

namespace frontlux::bench {
namespace {

using planner::TravelCorridor;

std::vector<VoxelKey> free_voxels(const VoxelGrid& grid, const KeyBox& box, int stride) {
  std::vector<VoxelKey> voxels;
  const auto first = [stride](std::uint16_t k) { return (k + stride - 1) / stride * stride; };
  for (int x = first(box.min.x); x <= box.max.x; x += stride)
    for (int y = first(box.min.y); y <= box.max.y; y += stride)
      for (int z = first(box.min.z); z <= box.max.z; z += stride) {
        const VoxelKey key = make_key(x, y, z);
        if (grid.at(key) == Occupancy::kFree) voxels.push_back(key);
      }
  return voxels;
}

// The largest of some corridors, each from a random cell.
std::vector<VoxelKey> largest_corridor(const planner::TravelOptions& travel, const VoxelGrid& grid,
                                       const KeyBox& bounds, const std::vector<VoxelKey>& starts) {
  constexpr unsigned kTrials = 64, kEnough = 6;
  TravelCorridor corridor(travel, grid.lattice(), bounds);
  std::vector<VoxelKey> best;
  for (unsigned trial = 0, found = 0; trial < kTrials && found < kEnough && !starts.empty(); ++trial) {
    corridor.update({grid},
                    starts[static_cast<std::size_t>(uniform(1, trial) * static_cast<double>(starts.size()))]);
    if (corridor.cells().empty()) continue;
    ++found;
    if (corridor.cells().size() > best.size()) best.assign(corridor.cells().begin(), corridor.cells().end());
  }
  return best;
}

// Frees all unknown voxels in view that no occupied voxel hides, as a camera would.
std::vector<VoxelKey> scan(VoxelGrid& grid, const RayCaster& caster, const VoxelKey& from, double yaw,
                           const FieldOfView& view) {
  const int reach = static_cast<int>(view.max_range / grid.resolution());
  std::vector<KeySegment> segments;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z) {
        if (!view.contains(Eigen::Vector3d(x, y, z) * grid.resolution(), yaw)) continue;
        const auto to = offset_key(from, x, y, z);
        if (to && grid.at(*to) == Occupancy::kUnknown) segments.push_back({from, *to});
      }
  std::vector<std::uint8_t> visible(segments.size());
  caster.visible(std::span<const KeySegment>(segments), visible, UnknownPolicy::kPass);
  std::vector<VoxelKey> changed;
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (visible[i] != 0) {
      grid.set(segments[i].to, Occupancy::kFree);
      changed.push_back(segments[i].to);
    }
  return changed;
}

std::vector<VoxelKey> frontiers_of(const VoxelGrid& grid, const KeyBox& bounds, Adjacency adjacency) {
  const FrontierSet set(grid, bounds, adjacency);
  return {set.keys().begin(), set.keys().end()};
}

}  // namespace

PlannerScene::PlannerScene(const Subject& map, Adjacency adjacency, std::size_t ground_count,
                           std::size_t aerial_count)
    : subject(map), ground(planner::ugv()), aerial(planner::uav()), scanned(map.grid) {
  const VoxelGrid& grid = subject.grid;
  const auto bounds = grid.known_bounds();
  if (bounds) frontiers = frontiers_of(grid, *bounds, adjacency);
  if (frontiers.empty()) throw std::runtime_error(subject.name + ": has no frontiers; give another map");
  const int up = static_cast<int>(ground.travel.sensor_height / grid.resolution()) + 1;
  KeyBox plane = *bounds;
  plane.min.z = plane.max.z = static_cast<std::uint16_t>(bounds->min.z + up);
  const auto on_plane = free_voxels(grid, plane, 1), in_space = free_voxels(grid, *bounds, 2);
  if (on_plane.empty() || in_space.empty())
    throw std::runtime_error(subject.name + ": has no free voxels where robots are; give another map");
  ground_viewpoints = thinned(on_plane, ground_count);
  aerial_viewpoints = thinned(in_space, aerial_count);
  ground_cells = largest_corridor(ground.travel, grid, *bounds, on_plane);
  aerial.travel.floor = (bounds->min.z + 1 - Lattice::kOrigin) * grid.resolution();
  aerial_cells = largest_corridor(aerial.travel, grid, *bounds, in_space);

  // The scan is taken from the viewpoint with the largest gain.
  const RayCaster& caster = subject.caster(kFast);
  ViewQualityOptions options;
  options.sampling = ViewQualityOptions::Sampling::kBuckets;
  options.azimuth_bins = kAzimuthBins;
  const auto image =
      render_view_quality(caster, grid.lattice(), aerial_viewpoints, frontiers, aerial.view, options);
  std::size_t best = 0;
  for (std::size_t i = 0; i < image.size(); ++i)
    if (image.values()[i].gain >= image.values()[best].gain) best = i;
  const AzimuthWindow window = best_window(image.bin_hits(best), aerial.view.horizontal);
  changed = scan(scanned, caster, image.viewpoints()[best], window.yaw, aerial.view);
  scanned_frontiers = frontiers_of(scanned, *bounds, adjacency);
}

std::vector<planner::FrontierAgent> PlannerScene::agents() const {
  return {{ground_cells, ground.view}, {aerial_cells, aerial.view}};
}

Rendering all_frontiers(const Subject& subject, const std::string& name, int azimuth_bins) {
  ViewQualityOptions options;
  options.azimuth_bins = azimuth_bins;
  options.samples = ViewQualityOptions::kAll;
  if (name == kExact) options.renderer = ViewQualityOptions::Renderer::kExact;
  return {name, &subject.caster(name == kExact ? kFast : name), options};
}

std::vector<VoxelKey> thinned(const std::vector<VoxelKey>& keys, std::size_t count) {
  if (keys.size() <= count) return keys;
  std::vector<VoxelKey> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(keys[i * keys.size() / count]);
  return some;
}

std::vector<VoxelKey> around_the_middle(std::vector<VoxelKey> keys, std::size_t count) {
  if (keys.size() <= count) return keys;
  const VoxelKey middle = keys[keys.size() / 2];
  const auto distance_sq = [&](const VoxelKey& key) {
    const int x = key.x - middle.x, y = key.y - middle.y, z = key.z - middle.z;
    return x * x + y * y + z * z;
  };
  std::ranges::stable_sort(keys, {}, distance_sq);
  keys.resize(count);
  return keys;
}

std::size_t differing(const ViewQualityImage& a, const ViewQualityImage& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    count += a.values()[i] != b.values()[i] || !std::ranges::equal(a.bin_hits(i), b.bin_hits(i)) ? 1 : 0;
  return count;
}

}  // namespace frontlux::bench
