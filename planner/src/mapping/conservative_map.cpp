#include "mapping/conservative_map.hpp"

#include <algorithm>

namespace frontlux::planner::detail {

std::vector<VoxelKey> ConservativeMap::update(const VoxelGrid& map, std::span<const VoxelKey> changed,
                                              std::span<const VoxelKey> under_robots) {
  std::vector<VoxelKey> further = hits_.take_changed();
  further.insert(further.end(), freed_.begin(), freed_.end());
  freed_.clear();
  const auto take_over = [&](const VoxelKey& key) {
    const Occupancy state = map.at(key);
    grid_.set(key, state == Occupancy::kFree && hits_.is_solid(key) ? Occupancy::kOccupied : state);
  };
  std::ranges::for_each(changed, take_over);
  std::ranges::for_each(further, take_over);
  for (const VoxelKey& key : under_robots) {
    if (grid_.at(key) != Occupancy::kOccupied) continue;
    grid_.set(key, Occupancy::kFree);
    freed_.push_back(key);
    further.push_back(key);
  }
  return further;
}

}  // namespace frontlux::planner::detail
