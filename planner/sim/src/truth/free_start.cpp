#include <frontlux/sim/ground.hpp>
#include <frontlux/sim/start_pose.hpp>
#include <frontlux/sim/surface.hpp>

#include <array>
#include <sstream>
#include <stdexcept>
#include <string>

namespace frontlux::sim {

Eigen::Vector3d free_start(const World& world, double resolution, bool faces_away) {
  if (!world.start) throw std::runtime_error(world.name + ": no start is known; give one in free space, x,y,z in metres");
  const Eigen::Vector3d& start = *world.start;
  const auto refuse = [&](const std::string& why) {
    std::ostringstream text;
    text << world.name << ": the start " << start.x() << ", " << start.y() << ", " << start.z() << " " << why;
    throw std::runtime_error(text.str());
  };
  if (!start.allFinite() || !world.bounds.contains(start))
    refuse("is outside of the world's bounds: give another one, or a box that holds it");
  const Lattice lattice(resolution);
  Eigen::Vector3d free = start;
  const auto floor = floor_below(world.mesh, start);
  const auto layer = lattice.key(start.z());
  // A floor on a voxel's face, but for rounding, is in the voxel below.
  constexpr double kOnFace = 1e-3;  // [m]
  const auto floor_layer = floor ? lattice.key(*floor - kOnFace) : std::nullopt;
  const bool on_floor = floor && start.z() - *floor < kOnFace;
  if (layer && floor_layer && (on_floor || *floor_layer >= *layer) &&
      *floor_layer < Lattice::kKeysPerAxis - 1) {
    free.z() = lattice.center(static_cast<std::uint16_t>(*floor_layer + 1));
    const auto still = floor_below(world.mesh, free);
    if (!world.bounds.contains(free) || !still || *still > *floor + kOnFace)
      refuse("has no room above the floor that it is on, at z = " + std::to_string(*floor) +
             ", in voxels of " + std::to_string(resolution) + " m; start elsewhere, or use smaller ones");
  }
  if (!faces_away) return free;
  const Surface surface(world.mesh);
  const Eigen::Vector3f from = free.cast<float>();
  const std::array<Surface::Ray, 2> rays{{{.origin = from, .direction = -Eigen::Vector3f::UnitZ()},
                                          {.origin = from, .direction = Eigen::Vector3f::UnitZ()}}};
  std::array<Surface::Hit, 2> hits;
  surface.cast(rays, hits);
  for (std::size_t i = 0; i < 2; ++i) {
    if (hits[i].triangle == Surface::kNone) continue;
    const auto [a, b, c] = corners_of(world.mesh, hits[i].triangle);
    if ((b - a).cross(c - a).dot(rays[i].direction.cast<double>()) > 0.0)
      refuse("is within a solid; give one in free space");
  }
  return free;
}

}  // namespace frontlux::sim
