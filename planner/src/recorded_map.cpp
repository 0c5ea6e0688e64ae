#include <frontlux/planner/recorded_map.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace frontlux::planner {
namespace {

using Robot16 = std::uint16_t;
constexpr Robot16 kNobody = std::numeric_limits<Robot16>::max();

// Who saw each voxel of 8 x 8 x 8 first.
using SeenBrick = std::array<Robot16, 512>;

std::uint64_t brick_of(const VoxelKey& key) {
  return (static_cast<std::uint64_t>(key.x >> 3U) << 26U) | (static_cast<std::uint64_t>(key.y >> 3U) << 13U) |
         static_cast<std::uint64_t>(key.z >> 3U);
}

std::size_t in_brick(const VoxelKey& key) {
  return (static_cast<std::size_t>(key.x & 7U) << 6U) | (static_cast<std::size_t>(key.y & 7U) << 3U) |
         static_cast<std::size_t>(key.z & 7U);
}

struct RobotsChange {
  VoxelChange change;
  Robot16 robot = 0;
};

// What a step does to one voxel.
struct Outcome {
  VoxelKey key;
  Occupancy state = Occupancy::kUnknown;
  Robot16 seen_by = kNobody;
};

std::string name_of(const VoxelKey& key) {
  return "(" + std::to_string(key.x) + ", " + std::to_string(key.y) + ", " + std::to_string(key.z) + ")";
}

std::vector<RobotsChange> all_changes(const std::vector<RobotStep>& robots) {
  std::vector<RobotsChange> all;
  for (std::size_t robot = 0; robot < robots.size(); ++robot)
    for (const VoxelChange& change : robots[robot].changed)
      all.push_back({change, static_cast<Robot16>(robot)});
  std::stable_sort(all.begin(), all.end(),
                   [](const RobotsChange& a, const RobotsChange& b) { return a.change.key < b.change.key; });
  return all;
}

}  // namespace

struct RecordedMap::State {
  explicit State(double resolution) : grid(resolution) {}

  void see(const VoxelKey& key, Robot16 robot) {
    const auto [entry, is_new] = seen.try_emplace(brick_of(key));
    if (is_new) entry->second.fill(kNobody);
    Robot16& first = entry->second[in_brick(key)];
    if (first == kNobody) first = robot;
  }

  // Changes of one voxel, in any order: taken as one after the other from what it is, the states between
  // cancel out, and what remains is the state at the end.
  [[nodiscard]] Outcome outcome(const RobotsChange* begin, const RobotsChange* end) const {
    Outcome outcome{begin->change.key, grid.at(begin->change.key), kNobody};
    bool begins = false;
    int state = static_cast<int>(outcome.state);
    for (const RobotsChange* c = begin; c != end; ++c) {
      // What a robot knew of its start, a recording may also list as a change of step 0.
      if (c->change.before == Occupancy::kUnknown) {
        if (at_start && outcome.state == Occupancy::kFree) state = static_cast<int>(Occupancy::kUnknown);
        outcome.seen_by = std::min(outcome.seen_by, c->robot);
      }
    }
    const int first = state;
    for (const RobotsChange* c = begin; c != end; ++c) {
      begins = begins || static_cast<int>(c->change.before) == first;
      state += static_cast<int>(c->change.after) - static_cast<int>(c->change.before);
    }
    if (!begins || state < 0 || state > 2)
      throw std::invalid_argument("recorded map: voxel " + name_of(outcome.key) + " is in state " +
                                  std::to_string(first) +
                                  ", with which its changes in this step do not begin");
    outcome.state = static_cast<Occupancy>(state);
    return outcome;
  }

  VoxelGrid grid;
  std::unordered_map<std::uint64_t, SeenBrick> seen;
  bool at_start = true;
};

RecordedMap::RecordedMap(const RecordingHead& head) : state_(std::make_unique<State>(head.resolution)) {
  for (std::size_t robot = 0; robot < head.starts.size(); ++robot)
    for (const VoxelKey& key : head.starts[robot].known_free)
      if (head.bounds.contains(key)) {
        state_->grid.set(key, Occupancy::kFree);
        state_->see(key, static_cast<Robot16>(robot));
      }
}
RecordedMap::~RecordedMap() = default;
RecordedMap::RecordedMap(RecordedMap&&) noexcept = default;
RecordedMap& RecordedMap::operator=(RecordedMap&&) noexcept = default;

void RecordedMap::apply(const RecordedStep& step) {
  if (step.step.robots.size() >= kNobody)
    throw std::invalid_argument("recorded map: " + std::to_string(step.step.robots.size()) + " robots");
  const auto all = all_changes(step.step.robots);
  std::vector<Outcome> outcomes;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].change.key == all[begin].change.key) ++end;
    outcomes.push_back(state_->outcome(all.data() + begin, all.data() + end));
  }
  for (const Outcome& outcome : outcomes) {
    state_->grid.set(outcome.key, outcome.state);
    if (outcome.seen_by != kNobody) state_->see(outcome.key, outcome.seen_by);
  }
  state_->at_start = false;
}

const VoxelGrid& RecordedMap::grid() const { return state_->grid; }

std::optional<std::size_t> RecordedMap::first_seen_by(const VoxelKey& key) const {
  const auto entry = state_->seen.find(brick_of(key));
  if (entry == state_->seen.end()) return std::nullopt;
  const Robot16 robot = entry->second[in_brick(key)];
  if (robot == kNobody) return std::nullopt;
  return robot;
}

}  // namespace frontlux::planner
