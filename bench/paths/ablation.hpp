#pragma once

#include "paths/methods.hpp"

#include <frontlux/planner/visible_pairs.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace frontlux::bench {

/// One method on one path.
struct YawTrial {
  std::uint64_t distinct = 0;  ///< frontiers in view
  double seconds = 0.0;        ///< [s] of processor time
  int evaluations = 0;
};

/// All methods on one path.
struct PathTrial {
  std::size_t pairs = 0;            ///< of viewpoint and visible frontier
  double visibility_seconds = 0.0;  ///< [s] of processor time for the rays between them
  std::vector<YawTrial> by_method;  ///< as `yaw_methods`
};

/// All paths of one map.
struct MapTrial {
  std::string name;
  std::size_t frontiers = 0;
  std::vector<PathTrial> paths;
};

/// The camera of the aerial robot: 90 x 72 degrees, 10 m.
[[nodiscard]] FieldOfView camera_view();

/// Every method on random paths of 12 viewpoints through a map.
/// @throws std::runtime_error if the map has no room for such a path
[[nodiscard]] MapTrial run_ablation(const std::string& name, const VoxelGrid& grid, int seeds);

/// Every method on a path of 12 viewpoints along a free box of 15 x 5.4 x 2.4 m, all around which is unknown:
/// more than 20,000 pairs.
[[nodiscard]] PathTrial run_large_path();

}  // namespace frontlux::bench
