#pragma once

#include <frontlux/map_change.hpp>
#include <frontlux/view_region.hpp>

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// Frontiers that a robot sees from none of its cells, unknown voxels not blocking, for as long as that is
/// certain: a frontier comes into view only where a voxel is no longer occupied or the robot can go to a new
/// place, and within its reach.
class UnseenFrontiers {
 public:
  /// Forgets those near what has changed.
  /// @param change    since the last call
  /// @param corridor  cells that the robot can go to now, sorted
  void update(const MapChange& change, std::span<const VoxelKey> corridor, const ViewRegion& view);

  /// Forgets all, the corridor too: whatever cells there are at the next call are new ones.
  void forget() {
    keys_.clear();
    corridor_.clear();
  }

  /// Those that have been tried from all cells of the corridor of the last update, sorted.
  void set(std::vector<VoxelKey> keys) { keys_ = std::move(keys); }

  [[nodiscard]] std::span<const VoxelKey> keys() const { return keys_; }

 private:
  std::vector<VoxelKey> keys_, corridor_;
  std::optional<VoxelGrid> grid_;  // of the last update
};

}  // namespace frontlux::planner::detail
