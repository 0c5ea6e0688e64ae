#include <frontlux/sim/scan_world.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace frontlux::sim {
namespace {

using planner::Pose;

using Cell = Eigen::Vector3i;

constexpr int kLongestEdge = 256;  // voxels

// The cells of a cube from its lowest corner, those in the middle first; ties by z, y, x.
std::vector<Cell> from_the_middle(const Cell& size) {
  std::vector<Cell> cells;
  for (int z = 0; z < size.z(); ++z)
    for (int y = 0; y < size.y(); ++y)
      for (int x = 0; x < size.x(); ++x) cells.emplace_back(x, y, z);
  std::stable_sort(cells.begin(), cells.end(), [&](const Cell& a, const Cell& b) {
    const auto off = [&](const Cell& c) { return (2 * c - size + Cell::Ones()).squaredNorm(); };
    return off(a) < off(b);
  });
  return cells;
}

}  // namespace

std::vector<Pose> sweep(const GroundTruth& truth, const planner::Robot& robot, const Pose& start,
                        double spacing) {
  if (!(std::isfinite(spacing) && spacing > 0.0))
    throw std::invalid_argument("sweep: a spacing of " + std::to_string(spacing) +
                                " m is not finite and positive");
  const Lattice& lattice = truth.lattice();
  const KeyBox& bounds = truth.bounds();
  const Cell first(bounds.min.x, bounds.min.y, bounds.min.z), last(bounds.max.x, bounds.max.y, bounds.max.z);
  // No cube needs to be larger than the world.
  const int longest = (last - first).maxCoeff() + 1;
  const int edge = static_cast<int>(
      std::clamp(std::round(spacing / lattice.resolution()), 1.0, static_cast<double>(longest)));
  if (edge > kLongestEdge)
    throw std::invalid_argument("sweep: a spacing of " + std::to_string(spacing) + " m is more than " +
                                std::to_string(kLongestEdge) + " voxels");

  const bool drives = robot.travel.motion == planner::Motion::kPlane;
  const double height = drives ? start.position.z() : 0.0;
  const auto layer = drives ? lattice.key(height) : std::nullopt;
  const Cell size(edge, edge, drives ? 1 : edge);
  const int lowest = drives ? layer.value() : first.z(), highest = drives ? lowest : last.z();
  const std::vector<Cell> candidates = from_the_middle(size);

  std::vector<Pose> views;
  for (int z = lowest; z <= highest; z += size.z())
    for (int y = first.y(); y <= last.y(); y += edge)
      for (int x = first.x(); x <= last.x(); x += edge)
        for (const Cell& offset : candidates) {
          const Cell cell = Cell(x, y, z) + offset;
          if ((cell.array() > last.array()).any()) continue;
          const VoxelKey key{static_cast<std::uint16_t>(cell.x()), static_cast<std::uint16_t>(cell.y()),
                             static_cast<std::uint16_t>(cell.z())};
          if (truth.at(key) != Truth::kFree) continue;
          const Pose pose{
              {lattice.center(key.x), lattice.center(key.y), drives ? height : lattice.center(key.z)}};
          if (obstacle_at(truth, robot, pose)) continue;
          const auto around = look_around(robot.view, pose);
          views.insert(views.end(), around.begin(), around.end());
          break;
        }
  return views;
}

}  // namespace frontlux::sim
