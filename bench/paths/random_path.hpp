#pragma once

#include <frontlux/planner/pose.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace frontlux::bench {

/// What random paths look like.
struct RandomPathOptions {
  std::size_t viewpoints = 12;
  double spacing = 1.2;    ///< [m] from one to the next
  double clearance = 0.8;  ///< [m] edge of a cube about every point of the path that is free
};

/// A walk through known free space that keeps its heading where it can. Every yaw is along the path.
/// @return nothing if 10,000 starts led nowhere
[[nodiscard]] std::optional<std::vector<planner::Pose>> random_path(const VoxelGrid& grid, std::uint64_t seed,
                                                                    const RandomPathOptions& options = {});

}  // namespace frontlux::bench
