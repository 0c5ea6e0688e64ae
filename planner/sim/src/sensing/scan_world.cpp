#include "sensing/counter_random.hpp"

#include <frontlux/sim/scan_world.hpp>

#include <stdexcept>
#include <string>

namespace frontlux::sim {

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
    mapping.insert(
        sense(surface, sensors[view.robot], view.sensor_pose, CounterRandom(options.seed, i).bits(0)));
    if (progress && !progress(i + 1)) return i + 1;
  }
  return views.size();
}

}  // namespace frontlux::sim
