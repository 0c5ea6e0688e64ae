#include "counter_random.hpp"

#include <frontlux/sim/scan_world.hpp>

namespace frontlux::sim {

std::size_t scan_world(const Surface& surface, std::span<const View> views, const ScanWorldOptions& options,
                       planner::Mapping& mapping, const ScanWorldProgress& progress) {
  const Sensor camera = depth_camera(options.errors), spinning = lidar(options.errors);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    const Sensor& sensor = view.robot == Robot::kUav ? camera : spinning;
    mapping.insert(sense(surface, sensor, view.sensor_pose, CounterRandom(options.seed, i).bits(0)));
    if (progress && !progress(i + 1)) return i + 1;
  }
  return views.size();
}

}  // namespace frontlux::sim
