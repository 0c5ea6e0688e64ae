#include "mapping/brick_table.hpp"
#include "mapping/octree_order.hpp"

#include <frontlux/planner/recorded_map.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace frontlux::planner {
namespace {

using RobotNumber = std::uint16_t;
constexpr RobotNumber kNobody = std::numeric_limits<RobotNumber>::max();

// Who mapped each voxel of a brick first.
struct FirstRobots {
  FirstRobots() { robots.fill(kNobody); }
  std::array<RobotNumber, 512> robots;
};

std::size_t in_brick(const VoxelKey& key) {
  return (static_cast<std::size_t>(key.x & 7U) << 6U) | (static_cast<std::size_t>(key.y & 7U) << 3U) |
         static_cast<std::size_t>(key.z & 7U);
}

std::string_view name_of(Occupancy state) {
  constexpr std::array<std::string_view, 3> kNames = {"unknown", "free", "occupied"};
  return kNames.at(static_cast<std::size_t>(state));
}

[[noreturn]] void refuse(const RecordedStep& step, std::size_t robot, const VoxelChange& change,
                         Occupancy is) {
  throw std::invalid_argument("recorded map: step " + std::to_string(step.step.number) + ", robot " +
                              std::to_string(robot) + ": voxel (" + std::to_string(change.key.x) + ", " +
                              std::to_string(change.key.y) + ", " + std::to_string(change.key.z) + ") is " +
                              std::string(name_of(is)) + " and not, as the step says, " +
                              std::string(name_of(change.before)));
}

}  // namespace

struct RecordedMap::State {
  explicit State(double resolution) : grid(resolution) {}
  VoxelGrid grid;
  detail::BrickTable<FirstRobots> first;
};

RecordedMap::RecordedMap(double resolution) : state_(std::make_unique<State>(resolution)) {}
RecordedMap::~RecordedMap() = default;
RecordedMap::RecordedMap(RecordedMap&&) noexcept = default;
RecordedMap& RecordedMap::operator=(RecordedMap&&) noexcept = default;

void RecordedMap::apply(const RecordedStep& step) {
  const auto& robots = step.step.robots;
  if (robots.size() >= kNobody)
    throw std::invalid_argument("recorded map: " + std::to_string(robots.size()) + " robots are too many");
  VoxelGrid after = state_->grid;
  for (std::size_t robot = 0; robot < robots.size(); ++robot)
    for (const VoxelChange& change : robots[robot].changed) {
      if (const Occupancy is = after.at(change.key); is != change.before) refuse(step, robot, change, is);
      after.set(change.key, change.after);
    }
  for (std::size_t robot = 0; robot < robots.size(); ++robot)
    for (const VoxelChange& change : robots[robot].changed) {
      if (change.before != Occupancy::kUnknown) continue;
      RobotNumber& first = state_->first[detail::brick_number(change.key)].robots[in_brick(change.key)];
      if (first == kNobody) first = static_cast<RobotNumber>(robot);
    }
  state_->grid = std::move(after);
}

const VoxelGrid& RecordedMap::grid() const { return state_->grid; }

std::optional<std::size_t> RecordedMap::first_seen_by(const VoxelKey& key) const {
  const FirstRobots* brick = state_->first.find(detail::brick_number(key));
  const RobotNumber robot = brick == nullptr ? kNobody : brick->robots[in_brick(key)];
  if (robot == kNobody) return std::nullopt;
  return robot;
}

}  // namespace frontlux::planner
