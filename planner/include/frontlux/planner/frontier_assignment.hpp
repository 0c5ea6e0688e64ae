#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner {

/// A frontier and a cell that sees it, or saw it once.
struct FrontierViewpoint {
  VoxelKey frontier;  ///< what is seen
  VoxelKey cell;      ///< from where
};

/// A robot in terms of frontiers: where it can go and what it sees from there.
struct FrontierAgent {
  std::span<const VoxelKey> corridor;  ///< in any order; if empty, the agent gets no frontiers
  /// What its sensor sees.
  FieldOfView view;
  /// Cells to test first, sorted by frontier. They do not change which frontiers are found, only how soon:
  /// most frontiers are still seen from where they were seen before.
  std::span<const FrontierViewpoint> previous_viewpoints = {};
  /// Frontiers that no cell sees, sorted: they are not tested.
  std::span<const VoxelKey> unseen = {};
};

/// The frontiers of one agent.
struct AssignedFrontiers {
  std::vector<std::uint32_t> frontiers;  ///< indices into the frontiers given, ascending
  std::vector<VoxelKey> seen_from;       ///< for each of them a cell of the corridor that sees it
  std::uint64_t rays = 0;                ///< cast to find them
};

/// The frontiers of each agent, and those of no agent.
struct FrontierAssignment {
  std::vector<AssignedFrontiers> assigned;  ///< to each agent, in the order given
  std::vector<std::uint32_t> unassigned;    ///< indices, ascending
};

/// The frontiers that an agent sees. It sees a frontier if, from some cell of its corridor, the frontier is
/// in view at some yaw and the ray to it meets no occupied voxel before it. Unknown voxels do not block.
///
/// The result, `seen_from` included, is the same on any number of threads.
/// @param caster  on the same map as `grid`, with rays between keys by the integer rule (not OctoMap's own)
/// @throws std::invalid_argument if the field of view is not valid, or if the corridor spans more than 2^24
/// cubes of 16 voxels
[[nodiscard]] FRONTLUX_EXPORT AssignedFrontiers find_visible_frontiers(const RayCaster& caster,
                                                                       const VoxelGrid& grid,
                                                                       std::span<const VoxelKey> frontiers,
                                                                       const FrontierAgent& agent);

/// Assigns each frontier to the first agent that sees it: the paper's frontier distribution, Alg. 2, which
/// takes the UGV first, then the UAV.
/// @throws std::invalid_argument as `find_visible_frontiers`
[[nodiscard]] FRONTLUX_EXPORT FrontierAssignment assign_frontiers(const RayCaster& caster,
                                                                  const VoxelGrid& grid,
                                                                  std::span<const VoxelKey> frontiers,
                                                                  std::span<const FrontierAgent> agents);

}  // namespace frontlux::planner
