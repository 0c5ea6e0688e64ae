#include "sensing/keyed_random.hpp"

#include <frontlux/file.hpp>
#include <frontlux/key_box.hpp>
#include <frontlux/planner/look_around.hpp>
#include <frontlux/sim/scan_world.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace frontlux::sim {
namespace {

using planner::Pose;
using Cell = Eigen::Vector3i;

constexpr int kLongestEdge = 256;                           // voxels
constexpr std::int64_t kMostCubes = std::int64_t{1} << 18;  // with a scan or more each: hours

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

  const bool drives = robot.travel.drives();
  const Cell size(edge, edge, drives ? 1 : edge);
  const int lowest = drives ? lattice.key(start.position.z()).value() : first.z(),
            highest = drives ? lowest : last.z();
  const Cell extent(last.x() - first.x() + 1, last.y() - first.y() + 1, highest - lowest + 1);
  const auto cubes = ((extent + size - Cell::Ones()).array() / size.array()).cast<std::int64_t>().prod();
  if (cubes > kMostCubes)
    throw std::invalid_argument("sweep: a spacing of " + decimals_of(spacing) + " m means looking at " +
                                std::to_string(cubes) + " places, more than " + std::to_string(kMostCubes) +
                                "; give a larger one");
  const std::vector<Cell> candidates = from_the_middle(size);

  std::vector<Pose> views;
  for (int z = lowest; z <= highest; z += size.z())
    for (int y = first.y(); y <= last.y(); y += edge)
      for (int x = first.x(); x <= last.x(); x += edge)
        for (const Cell& offset : candidates) {
          const Cell cell = Cell(x, y, z) + offset;
          if ((cell.array() > last.array()).any()) continue;
          const VoxelKey key = make_key(cell.x(), cell.y(), cell.z());
          if (truth.at(key) != Truth::kFree) continue;
          Pose pose{lattice.exact_center(key)};
          if (drives) pose.position.z() = start.position.z();
          if (obstacle_at(truth, robot, pose)) continue;
          const auto around = planner::look_around(robot.view, pose);
          views.insert(views.end(), around.begin(), around.end());
          break;
        }
  return views;
}

std::size_t scan_world(const Surface& surface, std::span<const planner::RobotDescription> robots,
                       std::span<const View> views, const ScanWorldOptions& options,
                       planner::Mapping& mapping, const ScanWorldProgress& progress) {
  std::vector<Sensor> sensors;
  for (const planner::RobotDescription& robot : robots) sensors.push_back(sensor_of(robot, options.errors));
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    if (view.robot >= sensors.size())
      throw std::invalid_argument("scan world: view " + std::to_string(i) + " is of robot " +
                                  std::to_string(view.robot) + ", but there are " +
                                  std::to_string(sensors.size()));
    mapping.insert(sense(surface, sensors[view.robot], view.sensor_pose, random_of(options.seed, i).bits()));
    if (progress && !progress(i + 1)) return i + 1;
  }
  return views.size();
}

}  // namespace frontlux::sim
