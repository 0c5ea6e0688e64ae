#pragma once

#include "mapping/hit_points.hpp"

#include <frontlux/voxel_grid.hpp>

#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// The map in motion, in which surfaces stay: rays that graze one free some of its voxels, until they are hit
/// again. What is behind those is no frontier, and on tours robots keep off them. So a voxel is occupied in
/// it that is so in the map, or that `HitPoints` holds for solid.
class ConservativeMap {
 public:
  /// @param map  at the beginning
  explicit ConservativeMap(VoxelGrid map) : grid_(std::move(map)), hits_(grid_) {}

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }

  /// Takes note of a scan that the map has taken in; `grid` changes with the next `update`.
  /// @return voxels that are free in the map and will be occupied here
  std::vector<VoxelKey> insert(const Scan& scan, const Mapping& mapping, const MapChange& change) {
    return hits_.insert(scan, mapping, change);
  }

  /// As `HitPoints` has it; `grid` changes with the next `update`.
  void forget(std::span<const VoxelKey> voxels) { hits_.forget(voxels); }

  /// Takes over changes of the map.
  /// @param changed       the voxels that may have changed in it since the last update
  /// @param under_robots  filled by robots' bodies: nothing else can be there, so that they are free until
  ///                      the next update
  /// @return further voxels that may have changed here
  [[nodiscard]] std::vector<VoxelKey> update(const VoxelGrid& map, std::span<const VoxelKey> changed,
                                             std::span<const VoxelKey> under_robots = {});

 private:
  VoxelGrid grid_;
  HitPoints hits_;
  std::vector<VoxelKey> freed_;  // in the last update, since a robot was there
};

}  // namespace frontlux::planner::detail
