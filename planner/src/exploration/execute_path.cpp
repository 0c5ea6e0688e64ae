#include "exploration/execute_path.hpp"

#include "mapping/sort_once.hpp"

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {
namespace {

// Whether a move stays in its voxel and leads towards the middle of it.
bool leads_to_the_middle(const Lattice& lattice, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  for (Eigen::Index a = 0; a < 3; ++a) {
    const auto key = lattice.key(from[a]);
    if (!key || lattice.key(to[a]) != key) return false;
    const double middle = lattice.center(*key);
    if (to[a] < std::min(from[a], middle) || to[a] > std::max(from[a], middle)) return false;
  }
  return true;
}

// The corridor is as old as the step; the map has changed since. A robot beside which something was found may
// move to the middle of its voxel, where it is free: it enters no other voxel on that move, though a round
// body may graze a corner.
bool is_still_free(const VoxelGrid& grid, const BodyStencil& body, const Pose& from, const Pose& to) {
  const Lattice& lattice = grid.lattice();
  const Eigen::Vector3d& begin =
      leads_to_the_middle(lattice, from.position, to.position) ? to.position : from.position;
  return SegmentVoxels(lattice, begin, to.position, body.reach()).all_of([&](const VoxelKey& cell) {
    return body.all_of(cell, [&](const VoxelKey& key) { return grid.at(key) == Occupancy::kFree; });
  });
}

// The voxels on a segment, but for that which it begins in. Sorted.
std::vector<VoxelKey> cells_beyond(const Lattice& lattice, const Pose& from, const Pose& to) {
  std::vector<VoxelKey> cells;
  SegmentVoxels(lattice, from.position, to.position).for_each([&](const VoxelKey& key) {
    cells.push_back(key);
  });
  if (const auto own = lattice.key(from.position)) std::erase(cells, *own);
  sort_once(cells);
  return cells;
}

Pose look_towards(const Pose& from, const Pose& to) {
  return {from.position, yaw_along(to.position - from.position, to.yaw)};
}

// Those of some voxels, in any order, that differ between two maps. Sorted by key.
std::vector<VoxelChange> differences(const VoxelGrid& before, const VoxelGrid& after,
                                     std::vector<VoxelKey> keys) {
  sort_once(keys);
  std::vector<VoxelChange> changed;
  for (const VoxelKey& key : keys) {
    const Occupancy was = before.at(key), is = after.at(key);
    if (was != is) changed.push_back({key, was, is});
  }
  return changed;
}

}  // namespace

std::size_t execute_path(std::size_t robot, RobotStep& step, const BodyStencil* body, const Drive& drive,
                         Mapping& mapping, std::span<const VoxelKey> known_free) {
  const VoxelGrid before = mapping.grid();
  std::vector<VoxelKey> touched;
  const auto touch = [&touched](const MapChange& change) {
    touched.insert(touched.end(), change.keys.begin(), change.keys.end());
  };
  touch(mapping.mark_free(known_free));
  const std::span<Pose> path = step.planned;
  step.blocked.clear();
  bool looked = false;  // at an obstacle
  for (step.travelled = std::min<std::size_t>(path.size(), 1); step.travelled < path.size();
       ++step.travelled) {
    const Pose& from = path[step.travelled - 1];
    Pose& to = path[step.travelled];
    if (body != nullptr && !is_still_free(mapping.grid(), *body, from, to)) break;
    auto scan = drive(robot, to);
    const bool blocked = !scan;
    if (blocked) {
      step.blocked = cells_beyond(mapping.grid().lattice(), from, to);
      to = look_towards(from, to);
      scan = drive(robot, to);
      if (!scan) break;
    }
    touch(mapping.insert(*scan));
    if (blocked) {
      ++step.travelled;
      looked = true;
      break;
    }
  }
  step.length = path_length(path.first(step.travelled));
  step.changed = differences(before, mapping.grid(), std::move(touched));
  return looked ? step.travelled - 1 : step.travelled;
}

}  // namespace frontlux::planner::detail
