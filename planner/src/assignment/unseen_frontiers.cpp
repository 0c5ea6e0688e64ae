#include "assignment/unseen_frontiers.hpp"

#include "mapping/box_array.hpp"
#include "mapping/cubes_of_keys.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace frontlux::planner::detail {
namespace {

constexpr std::uint64_t kMaxCubes = std::uint64_t{1} << 24;  // in the box around all changes

}  // namespace

void UnseenFrontiers::update(const MapChange& change, std::span<const VoxelKey> corridor,
                             const ViewRegion& region) {
  std::vector<VoxelKey> changed;
  if (!keys_.empty()) {
    std::set_difference(corridor.begin(), corridor.end(), corridor_.begin(), corridor_.end(),
                        std::back_inserter(changed));
    if (grid_)
      std::ranges::copy_if(change.keys, std::back_inserter(changed), [&](const VoxelKey& key) {
        return grid_->at(key) == Occupancy::kOccupied && change.grid.at(key) != Occupancy::kOccupied;
      });
  }
  corridor_.assign(corridor.begin(), corridor.end());
  grid_ = change.grid;
  if (changed.empty()) return;
  const std::vector<VoxelKey> cubes = cubes_of(changed);
  const int across = (region.reach() >> kLog2Cube) + 1, up = (region.greatest_height() >> kLog2Cube) + 1;
  const KeyBox box = grown(bounds_of(cubes), across, across, up);
  if (size_of(box) > kMaxCubes) {
    keys_.clear();
    return;
  }
  BoxArray<std::uint8_t> near(box);
  for (const VoxelKey& cube : cubes)
    for_each_key(grown({cube, cube}, across, across, up), [&](const VoxelKey& key) { near[key] = 1; });
  std::erase_if(keys_, [&](const VoxelKey& key) {
    const VoxelKey cube = cube_of(key);
    return box.contains(cube) && near[cube] != 0;
  });
}

}  // namespace frontlux::planner::detail
