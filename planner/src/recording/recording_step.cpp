#include "recording/recording_step.hpp"

#include "recording/recording_parts.hpp"

#include <algorithm>
#include <functional>
#include <string>
#include <type_traits>

namespace frontlux::planner::detail {
namespace {

constexpr int kStates = 3;  // of a voxel

// Pairs of states as one number, `3 before + after`.
template <class Bytes, class Change>
void code_states(Bytes& bytes, Change& change) {
  int pair = kStates * static_cast<int>(change.before) + static_cast<int>(change.after);
  bytes.small(pair, kStates * kStates - 1, "change of a voxel");
  if constexpr (!std::is_const_v<Change>) {
    change.before = static_cast<Occupancy>(pair / kStates);
    change.after = static_cast<Occupancy>(pair % kStates);
  }
  bytes.require(change.before != change.after, "a voxel changes to what it is");
}

template <class Bytes, class Changes>
void code_changes(Bytes& bytes, Changes& changes, const KeyBox& bounds) {
  bytes.length(changes, kKeyBytes + 1);
  bytes.keys(changes, &VoxelChange::key);
  for (auto& change : changes) {
    code_states(bytes, change);
    bytes.require(bounds.contains(change.key), "a voxel outside the bounds changes");
  }
  const auto not_below = [](const VoxelChange& a, const VoxelChange& b) { return a.key >= b.key; };
  bytes.require(std::adjacent_find(changes.begin(), changes.end(), not_below) == changes.end(),
                "the changes are not sorted by key, each voxel once");
}

template <class Bytes, class Keys>
void code_sorted_keys(Bytes& bytes, Keys& keys, const char* what) {
  code_keys(bytes, keys);
  bytes.require(std::adjacent_find(keys.begin(), keys.end(), std::greater_equal<>()) == keys.end(), what);
}

template <class Bytes, class Image>
void code_image(Bytes& bytes, Image& image) {
  bytes.length(image, kKeyBytes + 5 * sizeof(double) + 1);
  bytes.keys(image, &RenderedCell::cell);
  for (const auto column : {&RenderedCell::distance, &RenderedCell::gain, &RenderedCell::standard_error,
                            &RenderedCell::quality, &RenderedCell::yaw}) {
    bytes.numbers(image, column);
    for (const RenderedCell& cell : image)
      bytes.require(std::isfinite(cell.*column), "a number of a rendered cell is not finite");
  }
  for (auto& cell : image) bytes.count32(cell.hits);
}

template <class Bytes, class AnyGoal>
void code_goal(Bytes& bytes, AnyGoal& goal) {
  bytes.choice(goal.state, 7, "state of the goal");
  bytes.maybe(goal.pose, [&](auto& pose) { code_pose(bytes, pose); });
  bytes.require(goal.pose.has_value() == (goal.state <= GoalState::kUncovered),
                "there is a goal, but its state says that there is none, or the other way round");
  bytes.key(goal.cell);
  bytes.text(goal.reason);
  constexpr const char* kWhat = "a number of the goal is not finite";
  code_finite(bytes, goal.distance, kWhat);
  code_finite(bytes, goal.gain, kWhat);
  code_finite(bytes, goal.standard_error, kWhat);
  code_finite(bytes, goal.quality, kWhat);
  bytes.count(goal.assigned);
  bytes.count(goal.released);
  bytes.count(goal.received);
  bytes.count(goal.uncovered);
}

template <class Bytes, class Robot>
void code_robot(Bytes& bytes, Robot& robot, const KeyBox& bounds) {
  bytes.count(robot.gain_tangent);
  bytes.count(robot.gain_predicted);
  bytes.count(robot.gained);
  bytes.count(robot.travelled);
  code_length(bytes, robot.length, "what it travelled is no length");
  bytes.choice(robot.path, 7, "outcome of the path search");
  code_goal(bytes, robot.goal);
  bytes.length(robot.planned, 4 * sizeof(double));
  bytes.require(robot.travelled <= robot.planned.size(), "it came to more viewpoints than were planned");
  for (auto& pose : robot.planned) code_pose(bytes, pose);
  code_changes(bytes, robot.changed, bounds);
  code_sorted_keys(bytes, robot.still_unknown, "the still_unknown voxels are not sorted, each once");
  code_sorted_keys(bytes, robot.blocked, "the blocked cells are not sorted, each once");
  code_image(bytes, robot.image);
}

template <class Bytes, class Known>
void code_known(Bytes& bytes, Known& known, const RecordingHead& head) {
  bytes.length(known, 2);
  bytes.require(known.size() == head.robots.size(), "there is not one number for each robot");
  std::uint64_t observable_left = head.observable, bounding_left = head.bounding;
  for (auto& part : known) {
    bytes.count(part.observable);
    bytes.count(part.bounding);
    bytes.require(head.observable == 0 || part.observable <= observable_left,
                  "more voxels than can be known are");
    bytes.require(head.bounding == 0 || part.bounding <= bounding_left,
                  "more voxels are known than the bounds hold");
    observable_left -= part.observable;
    bounding_left -= part.bounding;
  }
}

template <class Bytes, class Recorded>
void code_step(Bytes& bytes, Recorded& recorded, const RecordingHead& head, std::uint64_t number) {
  constexpr std::size_t kRobotBytes = 60;  // at least
  auto& step = recorded.step;
  bytes.part("step " + std::to_string(number));
  bytes.count(step.number);
  bytes.require(step.number == number, "has another number");
  bytes.count(step.frontiers);
  bytes.count(step.unassigned);
  bytes.count(step.abandoned);
  bytes.require(step.unassigned <= step.frontiers && step.abandoned <= step.frontiers,
                "more frontiers are unassigned or abandoned than there are");
  bytes.count(step.rays);
  bytes.count(recorded.collisions);
  for (auto& seconds : step.seconds) code_length(bytes, seconds, "a phase takes no finite time");
  bytes.part("step " + std::to_string(number) + ", known voxels");
  code_known(bytes, recorded.known, head);
  bytes.part("step " + std::to_string(number));
  bytes.length(step.robots, kRobotBytes);
  bytes.require(step.robots.size() == head.robots.size(), "has not as many robots as the team");
  for (std::size_t i = 0; i < step.robots.size(); ++i) {
    bytes.part("step " + std::to_string(number) + ", robot " + std::to_string(i));
    code_robot(bytes, step.robots[i], head.bounds);
  }
}

}  // namespace

std::string step_bytes(const RecordedStep& step, const RecordingHead& head, std::uint64_t number) {
  RecordWriter writer;
  code_step(writer, step, head, number);
  return writer.bytes();
}

RecordedStep step_from(std::string_view bytes, const RecordingHead& head, std::uint64_t number) {
  RecordReader reader(bytes);
  RecordedStep step;
  code_step(reader, step, head, number);
  reader.end();
  return step;
}

}  // namespace frontlux::planner::detail
