#pragma once

#include <frontlux/sim/world.hpp>

namespace frontlux::sim {

/// Beyond this no coordinate of a mesh makes sense, and single precision does not either [m].
inline constexpr float kFarthestVertex = 1e9F;

/// @throws std::invalid_argument naming the vertex or triangle, if a coordinate is not finite or is beyond
/// `kFarthestVertex`, or an index has no vertex
void check(const TriangleMesh& mesh);

}  // namespace frontlux::sim
