#pragma once

#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/sensor.hpp>
#include <frontlux/sim/surface.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace frontlux::sim {

/// One look at the world: which robot's sensor, from where.
struct View {
  std::size_t robot = 0;  ///< its number in the list of robots
  planner::Pose sensor_pose;
};

/// Views from all over the free space. Space is divided into cubes of edge `spacing`. In each cube where the
/// robot fits somewhere, it looks around from the position nearest to the middle. A robot on a plane stays on
/// the layer that it starts on. In the order of the cubes: x fastest, z slowest.
/// @param start   of the robot's sensor
/// @param spacing [m], rounded to whole voxels, one at least
/// @throws std::invalid_argument unless the spacing is finite, positive and 256 voxels at most, and there are
/// no more than 2^18 cubes
[[nodiscard]] std::vector<planner::Pose> sweep(const GroundTruth& truth, const planner::Robot& robot,
                                               const planner::Pose& start, double spacing);

struct ScanWorldOptions {
  RangeErrors errors{};    ///< of all sensors
  std::uint64_t seed = 1;  ///< of the errors
};

/// Called after each scan with the number of those done; false stops.
using ScanWorldProgress = std::function<bool(std::size_t done)>;

/// Takes all views, in their order, into the map. The same arguments give the same map, on any number of
/// threads.
/// @return the number of scans taken: all, unless stopped
/// @throws std::invalid_argument if a robot's sensor is not valid, there is no robot of a view's number, or a
/// pose is not finite or outside the map's key range
std::size_t scan_world(const Surface& surface, std::span<const planner::RobotDescription> robots,
                       std::span<const View> views, const ScanWorldOptions& options,
                       planner::Mapping& mapping, const ScanWorldProgress& progress = {});

}  // namespace frontlux::sim
