#pragma once

#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Counts how often frontiers were in view and stayed unknown, and how often robots had to turn back on their
/// way to see them. After some of either they are abandoned.
class AbandonedFrontiers {
 public:
  /// @param max_visits  after which a frontier is abandoned
  explicit AbandonedFrontiers(int max_visits) : max_visits_(max_visits) {}

  /// These were in view and stayed unknown.
  void visited(std::span<const VoxelKey> frontiers) {
    for (const VoxelKey& key : frontiers)
      if (++visits_[key] == max_visits_) abandon(key);
  }

  /// A robot was on its way to see these, and the map closed around it. Where a passage is hardly wider than
  /// the robot, noise closes it whenever it is near, and opens it while it is away.
  void turned_back(std::span<const VoxelKey> frontiers) {
    constexpr int kMost = 5;
    for (const VoxelKey& key : frontiers)
      if (++turned_back_[key] == kMost) abandon(key);
  }

  /// These voxels have changed, sorted: those that are known now will be no frontiers any more.
  void forget_known(std::span<const VoxelKey> changed, const VoxelGrid& grid) {
    std::vector<VoxelKey> known;
    for (const VoxelKey& key : changed)
      if (grid.at(key) != Occupancy::kUnknown && visits_.erase(key) + turned_back_.erase(key) != 0)
        known.push_back(key);
    if (known.empty() || abandoned_.empty()) return;
    std::erase_if(abandoned_, [&](const VoxelKey& key) { return std::ranges::binary_search(known, key); });
  }

  /// Those that are not abandoned.
  /// @param frontiers  sorted
  [[nodiscard]] std::vector<VoxelKey> without_abandoned(std::span<const VoxelKey> frontiers) const {
    std::vector<VoxelKey> rest;
    rest.reserve(frontiers.size());
    std::ranges::set_difference(frontiers, abandoned_, std::back_inserter(rest));
    return rest;
  }

 private:
  void abandon(const VoxelKey& key) {
    const auto place = std::ranges::lower_bound(abandoned_, key);
    if (place == abandoned_.end() || *place != key) abandoned_.insert(place, key);
  }

  int max_visits_;
  std::map<VoxelKey, int> visits_, turned_back_;
  std::vector<VoxelKey> abandoned_;  // sorted
};

}  // namespace frontlux::planner::detail
