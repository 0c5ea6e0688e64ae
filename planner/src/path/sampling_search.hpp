#pragma once

#include "path/polyline.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/ray.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <span>

namespace frontlux::planner::detail {

/// What a random search works on. Start and goal lie in cells.
struct SamplingQuery {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();   ///< [m]
  std::span<const VoxelKey> cells;                  ///< where samples are drawn, uniformly; not empty
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();  ///< [m] within which cells have to be passable, too
  bool plane = false;                               ///< search along x and y at the height of the start
  std::uint64_t seed = 0;
};

struct SamplingResult {
  Polyline path;       ///< from start to goal; empty if none was found
  int iterations = 0;  ///< used
};

/// Searches with OMPL's RRT, RRT-Connect or RRT* until start and goal are joined or the iterations are used
/// up.
/// @pre `options.search` is not `kCorridor`
[[nodiscard]] SamplingResult sampling_search(const Lattice& lattice, const SamplingQuery& query,
                                             const PathOptions& options, const SegmentCheck& is_free);

}  // namespace frontlux::planner::detail
