#include "exploration/conservative_map.hpp"

#include <frontlux/key_box.hpp>

#include <algorithm>

namespace frontlux::planner::detail {
namespace {

// The occupied voxels of `grid` that hang together with one, itself included; none if they are a surface.
std::vector<VoxelKey> stray_return_at(const VoxelKey& first, const VoxelGrid& grid, const VoxelGrid& map) {
  std::vector<VoxelKey> group = {first};
  const auto is_stray = [&](const VoxelKey& neighbor) {
    if (grid.at(neighbor) != Occupancy::kOccupied || std::ranges::count(group, neighbor) > 0) return true;
    group.push_back(neighbor);
    return group.size() < ConservativeMap::kLeastSurface && map.at(neighbor) != Occupancy::kOccupied;
  };
  for (std::size_t i = 0; i < group.size(); ++i)
    if (!all_of(grown({group[i], group[i]}, 1), is_stray)) return {};
  return group;
}

}  // namespace

std::vector<VoxelKey> ConservativeMap::update(const VoxelGrid& map, std::span<const VoxelKey> changed,
                                              std::span<const VoxelKey> occupied) {
  std::vector<VoxelKey> all(changed.begin(), changed.end()), freed;
  for (const VoxelKey& key : under_robots_) grid_.set(key, Occupancy::kOccupied);
  all.insert(all.end(), under_robots_.begin(), under_robots_.end());
  under_robots_.clear();
  for (const VoxelKey& key : all) {
    if (grid_.at(key) != Occupancy::kOccupied)
      grid_.set(key, map.at(key));
    else if (map.at(key) == Occupancy::kFree)
      freed.push_back(key);
  }
  for (const VoxelKey& key : freed) {
    if (grid_.at(key) == Occupancy::kFree) continue;  // with another one
    const std::vector<VoxelKey> stray = stray_return_at(key, grid_, map);
    for (const VoxelKey& voxel : stray) grid_.set(voxel, Occupancy::kFree);
    all.insert(all.end(), stray.begin(), stray.end());
  }
  for (const VoxelKey& key : occupied) {
    if (grid_.at(key) != Occupancy::kOccupied) continue;
    grid_.set(key, Occupancy::kFree);
    under_robots_.push_back(key);
    all.push_back(key);
  }
  return all;
}

}  // namespace frontlux::planner::detail
