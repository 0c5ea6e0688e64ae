#include <frontlux/planner/recorded_map.hpp>

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

std::string name_of(Occupancy state) {
  constexpr std::array kNames = {"unknown", "free", "occupied"};
  return kNames.at(static_cast<std::size_t>(state));
}

[[noreturn]] void refuse(const RecordedStep& step, std::size_t robot, const VoxelChange& change,
                         Occupancy is) {
  throw std::invalid_argument("recorded map: step " + std::to_string(step.step.number) + ", robot " +
                              std::to_string(robot) + ": voxel (" + std::to_string(change.key.x) + ", " +
                              std::to_string(change.key.y) + ", " + std::to_string(change.key.z) + ") is " +
                              name_of(is) + " and not, as the step says, " + name_of(change.before));
}

}  // namespace

RecordedMap::RecordedMap(double resolution) : grid_(resolution) {}

void RecordedMap::apply(const RecordedStep& step) {
  const auto& robots = step.step.robots;
  VoxelGrid after = grid_;
  for (std::size_t robot = 0; robot < robots.size(); ++robot)
    for (const VoxelChange& change : robots[robot].changed) {
      if (const Occupancy is = after.at(change.key); is != change.before) refuse(step, robot, change, is);
      after.set(change.key, change.after);
    }
  grid_ = std::move(after);
}

}  // namespace frontlux::planner
