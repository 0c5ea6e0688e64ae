#include "exploration/conservative_map.hpp"

#include <frontlux/key_box.hpp>

#include <algorithm>
#include <utility>

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
  std::vector<VoxelKey> further = std::exchange(under_robots_, {}), freed;
  for (const VoxelKey& key : further) grid_.set(key, Occupancy::kOccupied);
  const auto take_over = [&](const VoxelKey& key) {
    if (grid_.at(key) != Occupancy::kOccupied)
      grid_.set(key, map.at(key));
    else if (map.at(key) == Occupancy::kFree)
      freed.push_back(key);
  };
  std::ranges::for_each(changed, take_over);
  std::ranges::for_each(further, take_over);
  for (const VoxelKey& key : freed) {
    if (grid_.at(key) == Occupancy::kFree) continue;  // with another one
    const std::vector<VoxelKey> stray = stray_return_at(key, grid_, map);
    for (const VoxelKey& voxel : stray) grid_.set(voxel, Occupancy::kFree);
    further.insert(further.end(), stray.begin(), stray.end());
  }
  for (const VoxelKey& key : occupied) {
    if (grid_.at(key) != Occupancy::kOccupied) continue;
    grid_.set(key, Occupancy::kFree);
    under_robots_.push_back(key);
    further.push_back(key);
  }
  return further;
}

}  // namespace frontlux::planner::detail
