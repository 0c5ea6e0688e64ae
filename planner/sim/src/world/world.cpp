#include <frontlux/sim/world.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace frontlux::sim {
namespace {

constexpr float kFarthestVertex = 1e9F;  // [m] single precision is of no use beyond

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

using Polygon = std::vector<Eigen::Vector3d>;

// What of a convex polygon lies on one side of a plane across an axis, and on it.
// @param side  1: where coordinates are less than the plane's, -1: where they are greater
void cut(const Polygon& polygon, int axis, double side, double plane, Polygon& kept) {
  kept.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double before = side * (plane - from[axis]), after = side * (plane - to[axis]);
    if (before >= 0.0) kept.push_back(from);
    if (before * after < 0.0) kept.push_back(from + before / (before - after) * (to - from));
  }
}

}  // namespace

std::array<Eigen::Vector3d, 3> corners_of(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {mesh.vertices[a].cast<double>(), mesh.vertices[b].cast<double>(), mesh.vertices[c].cast<double>()};
}

void check(const TriangleMesh& mesh) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("mesh: " + what); };
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (const float coordinate : mesh.vertices[i])
      if (!(std::abs(coordinate) <= kFarthestVertex))
        refuse("vertex " + std::to_string(i) + " has the coordinate " + std::to_string(coordinate) +
               ", but has to lie within 1e9 m");
  if (mesh.triangles.size() >= std::numeric_limits<std::uint32_t>::max())
    refuse(std::to_string(mesh.triangles.size()) + " triangles, but their numbers have to fit in 32 bits");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t vertex : mesh.triangles[i])
      if (vertex >= mesh.vertices.size())
        refuse("triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) +
               ", but there are " + std::to_string(mesh.vertices.size()));
}

Eigen::AlignedBox3d bounds_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) bounds.extend(mesh.vertices[vertex].cast<double>());
  return bounds;
}

double surface_area(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = corners_of(mesh, i);
    twice += (b - a).cross(c - a).norm();
  }
  return twice / 2.0;
}

double surface_area(const TriangleMesh& mesh, const Eigen::AlignedBox3d& box) {
  double twice = 0.0;
  Polygon polygon, kept;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto corners = corners_of(mesh, i);
    polygon.assign(corners.begin(), corners.end());
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        cut(polygon, axis, side, side < 0.0 ? box.min()[axis] : box.max()[axis], kept);
        polygon.swap(kept);
      }
    for (std::size_t k = 2; k < polygon.size(); ++k)
      twice += (polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]).norm();
  }
  return twice / 2.0;
}

std::optional<double> solid_volume(const TriangleMesh& mesh) {
  if (!is_closed(mesh)) return std::nullopt;
  // Seen from near the mesh, the tetrahedra whose volumes cancel stay small.
  const Eigen::Vector3d apex =
      mesh.triangles.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : bounds_of(mesh).center();
  double six_times = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = corners_of(mesh, i);
    six_times += (a - apex).dot((b - apex).cross(c - apex));
  }
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
