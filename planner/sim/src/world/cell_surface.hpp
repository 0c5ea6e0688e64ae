#pragma once

#include <frontlux/sim/world.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace frontlux::sim {

/// One side of a solid cell of a rectilinear lattice, beyond which there is no solid. For axis a the cell is
/// cell u along axis a + 1 and cell v along axis a + 2, in cyclic order; the side is on line `plane`.
struct CellFace {
  std::int32_t plane = 0, u = 0, v = 0;
};

/// Faces by axis, and by where they look: 0 down the axis, 1 up.
using CellFaces = std::array<std::array<std::vector<CellFace>, 2>, 3>;

/// Faces as triangles: runs of faces, and equal runs side by side, become rectangles, and rectangles share
/// every vertex on their sides, so that no crack is left through which a ray could slip.
/// @param faces       without repetition; reordered
/// @param coordinate  of lattice line `line` along `axis` [m]; increasing
[[nodiscard]] TriangleMesh mesh_of(CellFaces faces,
                                   const std::function<float(int axis, std::int32_t line)>& coordinate);

}  // namespace frontlux::sim
