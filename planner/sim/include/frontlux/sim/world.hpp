#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
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

/// The smallest box around all triangles; empty if there are none.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const TriangleMesh& mesh);

/// The truth that robots explore: what stands in for the real world. World frame, metres, z up.
struct World {
  std::string name;
  TriangleMesh mesh;
  Eigen::AlignedBox3d bounds;            ///< [m] the map never goes beyond; around the mesh
  std::optional<Eigen::Vector3d> start;  ///< [m] a place in free space, on or above the floor, if one is known
};

}  // namespace frontlux::sim
