#pragma once

#include "corridor/whole_voxels.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdlib>
#include <optional>

namespace frontlux::planner::detail {

/// The voxels below a robot that drives on which it stands or, on the ground, may stand: some layers of them.
/// Those beside them count as well, as far as they bridge gaps. None if it needs no ground.
class FloorBelow {
 public:
  FloorBelow(const TravelOptions& travel, double resolution) {
    const bool on_ground = travel.motion == Motion::kGround;
    if (!on_ground && !(travel.motion == Motion::kPlane && travel.require_ground)) return;
    const Eigen::Vector2d extents = ground_extents(travel);
    const int gap = gap_width(travel, resolution);
    const int reach = on_ground ? reached_from_below(travel, resolution) : 0;
    around_.emplace(Around{half_width(extents.x(), resolution) + gap,
                           half_width(extents.y(), resolution) + gap, layers_below(travel, resolution) + 1,
                           reach, gap});
  }

  template <class Visit>
  void for_each(const VoxelKey& cell, const Visit& visit) const {
    if (!around_) return;
    if (const auto middle = offset_key(cell, 0, 0, -around_->down))
      for_each_key(grown({*middle, *middle}, around_->x, around_->y, around_->reach), visit);
  }

  /// Whether a voxel is part of it.
  [[nodiscard]] bool contains(const VoxelKey& cell, const VoxelKey& key) const {
    return around_ && std::abs(key.x - cell.x) <= around_->x && std::abs(key.y - cell.y) <= around_->y &&
           std::abs(key.z - (cell.z - around_->down)) <= around_->reach;
  }

  /// Calls `visit(key)` for what may be holes, as `TravelOptions` has them, since a voxel has become free:
  /// that one, and gaps that it has bridged or holes that it has filled.
  template <class Visit>
  void for_each_hole_near(const VoxelGrid& grid, const VoxelKey& opened, const Visit& visit) const {
    if (!around_) return;
    for_each_key(grown({opened, opened}, around_->gap, around_->gap, around_->reach),
                 [&](const VoxelKey& key) {
                   if (grid.at(key) == Occupancy::kFree && is_hole(grid, key)) visit(key);
                 });
  }

 private:
  // Nothing above or below it is occupied, and it is no gap of a single voxel.
  [[nodiscard]] bool is_hole(const VoxelGrid& grid, const VoxelKey& key) const {
    const auto is_occupied = [&](int dx, int dy, int dz) {
      const auto other = offset_key(key, dx, dy, dz);
      return other && grid.at(*other) == Occupancy::kOccupied;
    };
    for (int z = -around_->reach; z <= around_->reach; ++z)
      if (is_occupied(0, 0, z)) return false;
    return !(is_occupied(-1, 0, 0) && is_occupied(1, 0, 0)) &&
           !(is_occupied(0, -1, 0) && is_occupied(0, 1, 0));
  }

  struct Around {
    int x, y;   // [voxels] to each side
    int down;   // from a cell to its floor
    int reach;  // layers above and below that one
    int gap;    // [voxels] the widest that is bridged
  };
  std::optional<Around> around_;
};

}  // namespace frontlux::planner::detail
