#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/exploration.hpp>

namespace frontlux::planner {

/// A start, with what the robot takes for free there without having seen it: the voxels of its body, those of
/// its node if it moves through nodes, and those whose middles are within a radius of its sensor. Of a robot
/// that drives the radius counts along the floor, from the bottom of its body up to its sensor; it needs some
/// 2 m, since its sensor does not see the floor on which it stands. Nobody checks that nothing is there, and
/// scans correct it slowly.
/// @param pose         of its sensor
/// @param free_radius  [m] 0: its body alone
/// @throws std::invalid_argument if the pose is not finite or outside the key range, if the radius is not 0
///         to 100 m, or if it reaches over more than 2^24 voxels
[[nodiscard]] FRONTLUX_EXPORT ExplorationStart start_at(const Lattice& lattice, const Robot& robot,
                                                        const Pose& pose, double free_radius = 0.0);

}  // namespace frontlux::planner
