#pragma once

#include <frontlux/field_of_view.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner {

/// A cell from which a frontier is seen, or was seen once.
struct FrontierSight {
  VoxelKey frontier, cell;
};

/// A robot, as far as frontiers concern it: where it can go and what it sees from there.
struct FrontierAgent {
  std::span<const VoxelKey> corridor;  ///< in any order; none: it gets no frontiers
  FieldOfView view;
  /// Cells to try first, sorted by frontier. They have no bearing on which frontiers are found, only on how
  /// soon: what has been seen from somewhere is mostly still seen from there.
  std::span<const FrontierSight> tried_first = {};
  /// Frontiers that are known to be seen from no cell, sorted: not tried at all.
  std::span<const VoxelKey> unseen = {};
};

/// The frontiers of one agent.
struct AssignedFrontiers {
  std::vector<std::uint32_t> frontiers;  ///< indices into the frontiers given, ascending
  std::vector<VoxelKey> seen_from;       ///< a cell of the corridor that sees each of them
  std::uint64_t rays = 0;                ///< cast to find out
};

/// The frontiers of each agent, and those that are nobody's.
struct FrontierAssignment {
  std::vector<AssignedFrontiers> assigned;      ///< of each agent, in the order given
  std::vector<std::uint32_t> unassigned;  ///< indices, ascending
};

/// The paper's Alg. 2: a frontier is the agent's if from some cell of its corridor it is in view at some yaw,
/// and the ray from that cell meets no occupied voxel before it. Unknown voxels do not block.
///
/// Which frontiers these are depends on no order in which rays are cast. The same answer, `seen_from`
/// included, on any number of threads.
/// @param caster  on the same map as `grid`, with rays between keys by the integer rule (not OctoMap's own)
/// @throws std::invalid_argument if the field of view is broken, or the corridor spans more than 2^24 cubes
/// of
///         16 voxels
[[nodiscard]] AssignedFrontiers find_visible_frontiers(const RayCaster& caster, const VoxelGrid& grid,
                                                   std::span<const VoxelKey> frontiers,
                                                   const FrontierAgent& agent);

/// Gives all frontiers to the first agent that can see them: the UGV first, then the UAV. A single agent
/// takes what it sees.
/// @throws std::invalid_argument as `find_visible_frontiers`
[[nodiscard]] FrontierAssignment assign_frontiers(const RayCaster& caster, const VoxelGrid& grid,
                                                        std::span<const VoxelKey> frontiers,
                                                        std::span<const FrontierAgent> agents);

}  // namespace frontlux::planner
