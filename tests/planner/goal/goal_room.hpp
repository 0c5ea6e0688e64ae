#pragma once

#include "planner/corridor/dijkstra.hpp"
#include "support/random.hpp"
#include "support/views.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/planner/goal_selection.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

namespace frontlux::test {

/// A closed room of known space on a floor at z = 0, to be furnished. Cells are counted from its corner.
struct GoalRoom {
  static constexpr int kLow = Lattice::kOrigin;
  int length, height;
  VoxelGrid grid{0.3};

  GoalRoom(int edge, int layers) : length(edge), height(layers) {
    fill(grid, bounds(), Occupancy::kFree);
    fill(grid, {key(0, 0, -1), key(edge - 1, edge - 1, -1)}, Occupancy::kOccupied);
  }

  /// Pillars, crates and places that were never seen.
  GoalRoom(int edge, int layers, std::uint64_t seed) : GoalRoom(edge, layers) {
    Random random(seed);
    for (int i = 0; i < 5; ++i) box(random, 1 + random.below(2), layers, Occupancy::kOccupied);
    for (int i = 0; i < 9; ++i) box(random, 1 + random.below(4), 4, Occupancy::kUnknown);
  }

  [[nodiscard]] static VoxelKey key(int x, int y, int z) { return key_at(x, y, z); }
  VoxelKey unknown(int x, int y, int z) {
    grid.set(key(x, y, z), Occupancy::kUnknown);
    return key(x, y, z);
  }
  [[nodiscard]] KeyBox bounds() const { return {key(0, 0, -1), key(length - 1, length - 1, height - 1)}; }

  void box(Random& random, int edge, int layers, Occupancy state) {
    VoxelKey corner = random.key_in({key(0, 0, 0), bounds().max});
    if (layers == height) corner.z = kLow;
    const KeyBox voxels{corner, make_key(corner.x + edge - 1, corner.y + edge - 1, corner.z + layers - 1)};
    fill(grid, *intersection(voxels, bounds()), state);
  }

  [[nodiscard]] std::vector<VoxelKey> frontiers() const {
    const FrontierSet set(grid, bounds());
    return {set.keys().begin(), set.keys().end()};
  }

  [[nodiscard]] planner::Pose pose(int x, int y, int z) const {
    return {grid.lattice().exact_center(key(x, y, z)), 0.0};
  }

  /// Makes room for a robot around a cell, and floor under it.
  void clear(int x0, int y0, int z0, int half = 2) {
    fill(grid, {key(x0 - half, y0 - half, std::max(z0 - half, 0)), key(x0 + half, y0 + half, z0 + half)},
         Occupancy::kFree);
  }
};

/// The paper's Alg. 2, ray by ray.
inline std::vector<VoxelKey> naive_assigned(const RayCaster& caster, double resolution,
                                            const std::vector<VoxelKey>& frontiers,
                                            std::span<const VoxelKey> corridor, const FieldOfView& view) {
  std::vector<VoxelKey> assigned;
  for (const VoxelKey& frontier : frontiers)
    for (const VoxelKey& cell : corridor)
      if (view.contains_at_some_yaw(offset_between(cell, frontier, resolution)) &&
          is_visible(caster, {cell, frontier}, UnknownPolicy::kPass)) {
        assigned.push_back(frontier);
        break;
      }
  return assigned;
}

/// The frontiers that are visible from a cell at some yaw, through known free space.
inline std::vector<VoxelKey> naive_seen(const RayCaster& caster, double resolution, const VoxelKey& from,
                                        const std::vector<VoxelKey>& frontiers, const FieldOfView& view) {
  std::vector<VoxelKey> seen;
  for (const VoxelKey& frontier : frontiers)
    if (view.contains_at_some_yaw(offset_between(from, frontier, resolution)) &&
        is_visible(caster, {from, frontier}, UnknownPolicy::kBlock))
      seen.push_back(frontier);
  return seen;
}

/// How many steps through faces lie between a cell and the others of a corridor.
inline std::map<VoxelKey, int> naive_steps(std::span<const VoxelKey> corridor, const VoxelKey& from) {
  auto steps = dijkstra({corridor.begin(), corridor.end()}, from, 1, planner::PathMetric::kSteps);
  for (auto& [cell, length] : steps) length /= kStepLengths[1];
  return steps;
}

}  // namespace frontlux::test
