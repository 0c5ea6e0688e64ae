#pragma once

#include "support/random.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/goal_selection.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <queue>
#include <set>
#include <vector>

namespace frontlux::test {

inline std::uint16_t small_key(int k) { return static_cast<std::uint16_t>(k); }

/// A closed room of known space on a floor at z = 0, to be furnished. Cells are counted from its corner.
struct GoalRoom {
  static constexpr int kLow = Lattice::kOrigin;
  int length, height;
  VoxelGrid grid{0.3};

  GoalRoom(int edge, int layers) : length(edge), height(layers) {
    for_each_cell([&](int x, int y, int z) { grid.set(key(x, y, z), Occupancy::kFree); });
    for (int x = 0; x < length; ++x)
      for (int y = 0; y < length; ++y) grid.set(key(x, y, -1), Occupancy::kOccupied);
  }

  /// Pillars, crates and places that were never seen.
  GoalRoom(int edge, int layers, std::uint64_t seed) : GoalRoom(edge, layers) {
    Random random(seed);
    for (int i = 0; i < 5; ++i) box(random, 1 + random.below(2), layers, Occupancy::kOccupied);
    for (int i = 0; i < 9; ++i) box(random, 1 + random.below(4), 4, Occupancy::kUnknown);
  }

  [[nodiscard]] static VoxelKey key(int x, int y, int z) {
    return {small_key(kLow + x), small_key(kLow + y), small_key(kLow + z)};
  }
  [[nodiscard]] KeyBox bounds() const { return {key(0, 0, -1), key(length - 1, length - 1, height - 1)}; }

  template <class Visit>
  void for_each_cell(const Visit& visit) const {
    for (int x = 0; x < length; ++x)
      for (int y = 0; y < length; ++y)
        for (int z = 0; z < height; ++z) visit(x, y, z);
  }

  void box(Random& random, int edge, int layers, Occupancy state) {
    const int x0 = random.below(length), y0 = random.below(length), z0 = random.below(height);
    for (int x = x0; x < std::min(x0 + edge, length); ++x)
      for (int y = y0; y < std::min(y0 + edge, length); ++y)
        for (int z = layers == height ? 0 : z0; z < std::min(z0 + layers, height); ++z)
          grid.set(key(x, y, z), state);
  }

  [[nodiscard]] std::vector<VoxelKey> frontiers() const {
    const planner::FrontierSet set(grid, bounds());
    return {set.keys().begin(), set.keys().end()};
  }

  [[nodiscard]] planner::Pose pose(int x, int y, int z) const {
    const VoxelKey at = key(x, y, z);
    const Lattice& lattice = grid.lattice();
    return {{lattice.center(at.x), lattice.center(at.y), lattice.center(at.z)}, 0.0};
  }

  /// Makes room for a robot around a cell, and floor under it.
  void clear(int x0, int y0, int z0, int half = 2) {
    for (int x = x0 - half; x <= x0 + half; ++x)
      for (int y = y0 - half; y <= y0 + half; ++y)
        for (int z = std::max(z0 - half, 0); z <= z0 + half; ++z) grid.set(key(x, y, z), Occupancy::kFree);
  }
};

/// From one voxel's centre to another's [m].
inline Eigen::Vector3d offset_between(const VoxelKey& from, const VoxelKey& to, double resolution) {
  return Eigen::Vector3d(to.x - from.x, to.y - from.y, to.z - from.z) * resolution;
}

/// One ray.
inline bool is_visible(const RayCaster& caster, const VoxelKey& from, const VoxelKey& to,
                       UnknownPolicy unknown) {
  const KeySegment segment{from, to};
  std::uint8_t visible = 0;
  caster.visible({&segment, 1}, {&visible, 1}, unknown);
  return visible != 0;
}

/// The paper's Alg. 2, ray by ray.
inline std::vector<VoxelKey> naive_share(const RayCaster& caster, double resolution,
                                         const std::vector<VoxelKey>& frontiers,
                                         std::span<const VoxelKey> corridor, const FieldOfView& view) {
  std::vector<VoxelKey> share;
  for (const VoxelKey& frontier : frontiers)
    for (const VoxelKey& cell : corridor)
      if (view.contains_at_some_yaw(offset_between(cell, frontier, resolution)) &&
          is_visible(caster, cell, frontier, UnknownPolicy::kPass)) {
        share.push_back(frontier);
        break;
      }
  return share;
}

/// The frontiers that are visible from a cell at some yaw, through known free space.
inline std::vector<VoxelKey> naive_seen(const RayCaster& caster, double resolution, const VoxelKey& from,
                                        const std::vector<VoxelKey>& frontiers, const FieldOfView& view) {
  std::vector<VoxelKey> seen;
  for (const VoxelKey& frontier : frontiers)
    if (view.contains_at_some_yaw(offset_between(from, frontier, resolution)) &&
        is_visible(caster, from, frontier, UnknownPolicy::kBlock))
      seen.push_back(frontier);
  return seen;
}

/// How many steps through faces lie between a cell and the others of a corridor.
inline std::map<VoxelKey, int> naive_steps(std::span<const VoxelKey> corridor, const VoxelKey& from) {
  const std::set<VoxelKey> cells(corridor.begin(), corridor.end());
  std::map<VoxelKey, int> steps{{from, 0}};
  std::queue<VoxelKey> open({from});
  for (; !open.empty(); open.pop()) {
    const VoxelKey at = open.front();
    for (int axis = 0; axis < 3; ++axis)
      for (const int by : {-1, 1}) {
        VoxelKey next = at;
        std::uint16_t& k = axis == 0 ? next.x : axis == 1 ? next.y : next.z;
        k = small_key(k + by);
        if (cells.contains(next) && steps.try_emplace(next, steps[at] + 1).second) open.push(next);
      }
  }
  return steps;
}

}  // namespace frontlux::test
