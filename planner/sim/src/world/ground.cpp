#include <frontlux/sim/ground.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::sim {
namespace {

constexpr double kBelowBoundary = 0.05;  // [m]
constexpr double kReach = 0.01;          // [m] above the point
constexpr double kRightAlready = 1e-5;   // [m] coordinates are floats

std::string to_text(const Eigen::Vector3d& p) {
  return std::to_string(p.x()) + "," + std::to_string(p.y()) + "," + std::to_string(p.z());
}

}  // namespace

std::optional<double> floor_below(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  std::optional<double> floor;
  for (std::size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    std::array<Eigen::Vector3d, 3> corner = corners_of(mesh, triangle);
    for (Eigen::Vector3d& c : corner) c -= point;
    // Twice the areas, seen from above, of the triangles that the point makes with each side.
    std::array<double, 3> area{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto &a = corner[(i + 1) % 3], &b = corner[(i + 2) % 3];
      area[i] = a.x() * b.y() - a.y() * b.x();
    }
    const double all = area[0] + area[1] + area[2];
    const auto [least, most] = std::minmax_element(area.begin(), area.end());
    if (all == 0.0 || (*least < 0.0 && *most > 0.0)) continue;
    const double z =
        (area[0] * corner[0].z() + area[1] * corner[1].z() + area[2] * corner[2].z()) / all + point.z();
    if (z <= point.z() + kReach && (!floor || z > *floor)) floor = z;
  }
  return floor;
}

double align_ground(World& world, std::optional<double> ground_z, double resolution) {
  if (!std::isfinite(resolution) || resolution <= 0.0)
    throw std::invalid_argument("align_ground: resolution " + std::to_string(resolution) +
                                " m is not finite and positive");
  if (ground_z && !std::isfinite(*ground_z))
    throw std::invalid_argument("align_ground: the floor's height is not finite");
  if (!ground_z) {
    if (!world.start || !world.start->allFinite())
      throw std::invalid_argument("align_ground: neither the floor's height nor a start above it is known");
    ground_z = floor_below(world.mesh, *world.start);
    if (!ground_z)
      throw std::runtime_error(world.name + ": there is no floor below the start " + to_text(*world.start) +
                               "; give a start above a floor, or the floor's height");
  }
  const double below = std::min(kBelowBoundary, resolution / 2.0);
  const double shift = std::round((*ground_z + below) / resolution) * resolution - below - *ground_z;
  if (std::abs(shift) <= kRightAlready) return 0.0;
  for (auto& vertex : world.mesh.vertices)
    vertex.z() = static_cast<float>(static_cast<double>(vertex.z()) + shift);
  if (!world.bounds.isEmpty()) world.bounds.translate(Eigen::Vector3d(0.0, 0.0, shift));
  if (world.start) world.start->z() += shift;
  return shift;
}

}  // namespace frontlux::sim
