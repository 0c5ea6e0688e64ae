#include "exploration/path_execution.hpp"

#include <frontlux/planner/segment_voxels.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace frontlux::planner::detail {
namespace {

bool is_free(const VoxelGrid& grid, const KeyBox& box) {
  return all_of(box, [&](const VoxelKey& key) { return grid.at(key) == Occupancy::kFree; });
}

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

// The corridor is as old as the step; the map has learnt since. A robot beside which something was found may
// move to the middle of its voxel, where it is free: on the way it comes to no voxel that it is not in.
bool is_still_free(const VoxelGrid& grid, const TravelOptions& body, const Pose& from, const Pose& to) {
  const Lattice& lattice = grid.lattice();
  const Eigen::Vector3d& begin =
      leads_to_the_middle(lattice, from.position, to.position) ? to.position : from.position;
  return SegmentVoxels(lattice, begin, to.position, reach_of(body, lattice)).all_of([&](const VoxelKey& key) {
    return is_free(grid, voxels_of_cell(body, lattice, key));
  });
}

// The voxels on a way, but for that which it begins in.
std::vector<VoxelKey> cells_beyond(const Lattice& lattice, const Pose& from, const Pose& to) {
  std::vector<VoxelKey> cells;
  static_cast<void>(SegmentVoxels(lattice, from.position, to.position).all_of([&](const VoxelKey& key) {
    cells.push_back(key);
    return true;
  }));
  const auto x = lattice.key(from.position.x()), y = lattice.key(from.position.y()),
             z = lattice.key(from.position.z());
  if (x && y && z) std::erase(cells, VoxelKey{*x, *y, *z});
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

Pose look_towards(const Pose& from, const Pose& to) {
  const Eigen::Vector3d on = to.position - from.position;
  const bool level = on.x() != 0.0 || on.y() != 0.0;
  return {from.position, level ? std::atan2(on.y(), on.x()) : to.yaw};
}

}  // namespace

std::vector<VoxelChange> differences(const VoxelGrid& before, const VoxelGrid& after,
                                     std::vector<VoxelKey> candidates) {
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  std::vector<VoxelChange> changed;
  for (const VoxelKey& key : candidates) {
    const Occupancy was = before.at(key), is = after.at(key);
    if (was != is) changed.push_back({key, was, is});
  }
  return changed;
}

PathExecution travel(std::size_t robot, std::span<Pose> viewpoints, const TravelOptions* body,
                     const Drive& drive, Mapping& mapping) {
  PathExecution journey;
  if (viewpoints.empty()) return journey;
  const VoxelGrid before = mapping.grid();
  std::vector<VoxelKey> touched;
  for (journey.travelled = 1; journey.travelled < viewpoints.size(); ++journey.travelled) {
    const Pose& from = viewpoints[journey.travelled - 1];
    Pose& to = viewpoints[journey.travelled];
    if (body != nullptr && !is_still_free(mapping.grid(), *body, from, to)) break;
    auto scan = drive(robot, to);
    const bool blocked = !scan;
    if (blocked) {
      journey.blocked = cells_beyond(mapping.grid().lattice(), from, to);
      to = look_towards(from, to);
      scan = drive(robot, to);
      if (!scan) break;
    }
    const auto keys = mapping.insert(*scan).keys;
    touched.insert(touched.end(), keys.begin(), keys.end());
    if (blocked) {
      ++journey.travelled;
      break;
    }
  }
  journey.length = path_length(viewpoints.first(journey.travelled));
  journey.changed = differences(before, mapping.grid(), std::move(touched));
  return journey;
}

}  // namespace frontlux::planner::detail
