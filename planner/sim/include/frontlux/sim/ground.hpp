#pragma once

#include <frontlux/sim/world.hpp>

#include <Eigen/Core>

#include <optional>

namespace frontlux::sim {

/// Height [m] of the first surface straight below a point or at most 1 cm above it, because a point on the
/// floor may be rounded to below it; nothing if there is none. Vertical surfaces do not count.
[[nodiscard]] std::optional<double> floor_below(const TriangleMesh& mesh, const Eigen::Vector3d& point);

/// Shifts a world along z, by at most half a voxel, so that its floor lies 0.05 m (half a voxel, if that is
/// less) below a voxel boundary. Otherwise a floor that lies on a boundary is mapped into the lowest layer
/// that a robot stands in. The mesh, the bounds and the start all move: add the shift to every other height
/// known in the old frame.
/// @param ground_z   the floor's height now [m]; if nothing, that of the floor below the start
/// @param resolution edge length of a voxel [m]
/// @return the shift [m]; 0 if the floor lies right already
/// @throws std::invalid_argument if a number is not finite, or the resolution not positive, or neither
///         height nor start is known
/// @throws std::runtime_error if there is no floor below the start
double align_ground(World& world, std::optional<double> ground_z, double resolution);

}  // namespace frontlux::sim
