#pragma once

#include "support/voxel_keys.hpp"

#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/travel_corridor.hpp>

namespace frontlux::test {

/// A square of known free space between the ends of the map, over a floor; its lower corner is the origin.
struct WalledSpace {
  VoxelGrid grid;
  KeyBox bounds;

  WalledSpace(int edge, int layers, double resolution)
      : grid(resolution), bounds{key_at(0, 0, -1), key_at(edge - 1, edge - 1, layers - 1)} {
    test::fill(grid, bounds, Occupancy::kFree);
    test::fill(grid, {bounds.min, key_at(edge - 1, edge - 1, -1)}, Occupancy::kOccupied);
  }
  [[nodiscard]] planner::TravelCorridor corridor(const planner::TravelOptions& options,
                                                 const VoxelKey& robot) const {
    planner::TravelCorridor made(options, grid.lattice(), bounds);
    made.update({grid}, robot);
    return made;
  }
};

/// What a robot's collision box takes around the voxel that holds it [voxels].
struct BodyBox {
  int half, below, above;
};

/// The box is in known free space all along the path, by so many samples in the length of a voxel.
inline void expect_free(const VoxelGrid& grid, std::span<const planner::Pose> path, const BodyBox& body,
                        int samples) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector3d from = path[i - 1].position, segment = path[i].position - from;
    const int steps = 1 + static_cast<int>(segment.norm() * samples / grid.resolution());
    for (int k = 0; k <= steps; ++k) {
      const Eigen::Vector3d at = from + segment * (static_cast<double>(k) / steps);
      const VoxelKey key = grid.lattice().key(at).value();
      const KeyBox box{make_key(key.x - body.half, key.y - body.half, key.z - body.below),
                       make_key(key.x + body.half, key.y + body.half, key.z + body.above)};
      ASSERT_TRUE(is_free(grid, box)) << "at " << at.transpose();
    }
  }
}

}  // namespace frontlux::test
