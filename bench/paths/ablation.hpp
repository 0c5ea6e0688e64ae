#pragma once

#include <frontlux/planner/path_optimizer.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::bench {

/// A method that chooses the yaws of a path.
struct YawMethod {
  std::string_view name;
  std::optional<planner::PathOptimizerOptions> options;  ///< none: yaws along the path
};

/// From the plain tangent to the default.
[[nodiscard]] std::vector<YawMethod> yaw_methods();

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

/// Every method on random paths of 12 viewpoints through a map.
/// @throws std::runtime_error if the map has no room for such a path
[[nodiscard]] MapTrial run_ablation(const std::string& name, const VoxelGrid& grid, int seeds);

/// Every method on a path of 12 viewpoints along a free box of 18 x 5.6 x 4 m, surrounded by unknown space:
/// more than 20,000 pairs.
[[nodiscard]] PathTrial run_large_path();

}  // namespace frontlux::bench
