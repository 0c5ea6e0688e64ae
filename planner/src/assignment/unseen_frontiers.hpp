#pragma once

#include <frontlux/map_change.hpp>
#include <frontlux/view_region.hpp>

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// Frontiers that a robot sees from none of its cells, even through unknown voxels. A frontier stays unseen
/// until, within its reach, a voxel stops being occupied or the robot can go to a new cell.
class UnseenFrontiers {
 public:
  /// Forgets the frontiers near what has changed.
  /// @param change    since the last call
  /// @param corridor  cells that the robot can go to now, sorted
  void update(const MapChange& change, std::span<const VoxelKey> corridor, const ViewRegion& region);

  /// Forgets all frontiers and the corridor: at the next call every cell is new.
  void forget() {
    keys_.clear();
    corridor_.clear();
  }

  /// @param keys  frontiers that no cell of the corridor of the last update sees, sorted
  void set(std::vector<VoxelKey> keys) { keys_ = std::move(keys); }

  [[nodiscard]] std::span<const VoxelKey> keys() const { return keys_; }

 private:
  std::vector<VoxelKey> keys_, corridor_;
  std::optional<VoxelGrid> grid_;  // of the last update
};

}  // namespace frontlux::planner::detail
