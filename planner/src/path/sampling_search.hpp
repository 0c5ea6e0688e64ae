#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/ray.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// What a random search works on. Start and goal lie in cells.
struct TreeQuery {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();   ///< [m]
  std::span<const VoxelKey> cells;                  ///< where samples are drawn, uniformly; not empty
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();  ///< [m] within which cells have to be passable, too
  bool plane = false;                               ///< search along x and y at the height of the start
  std::uint64_t seed = 0;
};

struct TreeAnswer {
  std::vector<Eigen::Vector3d> way;  ///< [m] bends from start to goal; empty if none was found
  int iterations = 0;
};

/// Grows trees through free space until they join start and goal or the iterations are used up.
/// @param way_is_free  whether a robot can go straight from one point [m] to another
/// @pre `options.search` is not `kCorridor`
[[nodiscard]] TreeAnswer search_tree(
    const Lattice& lattice, const TreeQuery& query, const PathOptions& options,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& way_is_free);

}  // namespace frontlux::planner::detail
