#include <frontlux/sim/world.hpp>

namespace frontlux::sim {

Eigen::AlignedBox3d bounds_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) bounds.extend(mesh.vertices[vertex].cast<double>());
  return bounds;
}

}  // namespace frontlux::sim
