#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::sim {

/// Surfaces. Triangles are seen from both sides, so their winding does not matter.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;                ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
};

/// The corners of a triangle [m].
[[nodiscard]] std::array<Eigen::Vector3d, 3> corners_of(const TriangleMesh& mesh, std::size_t triangle);

/// @throws std::invalid_argument naming the vertex or triangle, if a coordinate is not finite or beyond 1e9
/// m, an index has no vertex, or triangles cannot be numbered with 32 bits
void check(const TriangleMesh& mesh);

/// The smallest box around all triangles; empty if there are none.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const TriangleMesh& mesh);

/// Total area of all triangles [m^2].
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// Total area of what of the triangles lies in a box [m^2], its faces included.
[[nodiscard]] double surface_area(const TriangleMesh& mesh, const Eigen::AlignedBox3d& box);

/// Volume [m^3] of the solids whose surface the mesh is. Negative if the triangles face inwards, as in a mesh
/// of a room without its walls' thickness; solids that overlap count twice.
/// @return nothing if the surface is not closed and wound one way: some edge lacks its counterpart
[[nodiscard]] std::optional<double> solid_volume(const TriangleMesh& mesh);

/// A simulated world that robots explore. World frame, metres, z up.
struct World {
  std::string name;
  TriangleMesh mesh;
  Eigen::AlignedBox3d bounds;  ///< [m] the map never goes beyond the voxels in it (`GroundTruth::bounds`)
  std::optional<Eigen::Vector3d>
      start;  ///< [m] a place in free space, on or above the floor, if one is known
};

/// Number of voxels that meet `bounds`, counted without a limit; 0 if the box is empty. Check it before you
/// allocate a map of this size.
/// @param resolution edge length of a voxel [m]
/// @throws std::invalid_argument unless the resolution is finite and positive and the bounds are finite
[[nodiscard]] double voxel_count(const Eigen::AlignedBox3d& bounds, double resolution);

}  // namespace frontlux::sim
