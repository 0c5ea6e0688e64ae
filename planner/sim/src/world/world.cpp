#include <frontlux/sim/world.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace frontlux::sim {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Every directed edge is cancelled by one in the other direction.
bool is_closed(const TriangleMesh& mesh) {
  std::vector<Edge> forward, backward;
  forward.reserve(3 * mesh.triangles.size());
  backward.reserve(3 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles)
    for (const Edge& edge : {Edge{a, b}, Edge{b, c}, Edge{c, a}}) {
      forward.push_back(edge);
      backward.emplace_back(edge.second, edge.first);
    }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  return forward == backward;
}

}  // namespace

Eigen::AlignedBox3d bounds_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) bounds.extend(mesh.vertices[vertex].cast<double>());
  return bounds;
}

double surface_area(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d corner = mesh.vertices[a].cast<double>();
    twice +=
        (mesh.vertices[b].cast<double>() - corner).cross(mesh.vertices[c].cast<double>() - corner).norm();
  }
  return twice / 2.0;
}

std::optional<double> solid_volume(const TriangleMesh& mesh) {
  if (!is_closed(mesh)) return std::nullopt;
  // Seen from near the mesh, the tetrahedra whose volumes cancel stay small.
  const Eigen::Vector3d apex =
      mesh.triangles.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : bounds_of(mesh).center();
  double six_times = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    six_times +=
        (mesh.vertices[a].cast<double>() - apex)
            .dot((mesh.vertices[b].cast<double>() - apex).cross(mesh.vertices[c].cast<double>() - apex));
  return six_times / 6.0;
}

double voxel_count(const Eigen::AlignedBox3d& bounds, double resolution) {
  if (!std::isfinite(resolution) || resolution <= 0.0)
    throw std::invalid_argument("voxel_count: resolution " + std::to_string(resolution) +
                                " m is not finite and positive");
  if (bounds.isEmpty()) return 0.0;
  if (!bounds.min().allFinite() || !bounds.max().allFinite())
    throw std::invalid_argument("voxel_count: the bounds are not finite");
  double count = 1.0;
  for (int i = 0; i < 3; ++i)
    count *= std::floor(bounds.max()[i] / resolution) - std::floor(bounds.min()[i] / resolution) + 1.0;
  return count;
}

}  // namespace frontlux::sim
