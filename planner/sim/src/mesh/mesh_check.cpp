#include "mesh/mesh_check.hpp"

#include <limits>
#include <stdexcept>
#include <string>

namespace frontlux::sim {

void check(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (const float coordinate : mesh.vertices[i])
      if (!(coordinate >= -kFarthestVertex && coordinate <= kFarthestVertex))
        throw std::invalid_argument("mesh: vertex " + std::to_string(i) + " has the coordinate " +
                                    std::to_string(coordinate) + ", but has to lie within 1e9 m");
  }
  if (mesh.triangles.size() >= std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("mesh: " + std::to_string(mesh.triangles.size()) +
                                " triangles, but their numbers have to fit in 32 bits");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t vertex : mesh.triangles[i])
      if (vertex >= mesh.vertices.size())
        throw std::invalid_argument("mesh: triangle " + std::to_string(i) + " names vertex " +
                                    std::to_string(vertex) + ", but there are " +
                                    std::to_string(mesh.vertices.size()));
  }
}

}  // namespace frontlux::sim
