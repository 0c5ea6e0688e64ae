#include "recording/recording_format.hpp"

#include "recording/record_bytes.hpp"

#include <frontlux/lattice.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

namespace frontlux::planner::detail {
namespace {

constexpr std::size_t kKeyBytes = 3;  // at least
constexpr std::size_t kMostRecordedRobots = 1000;
constexpr std::size_t kMostOptionBytes = 1 << 24;
constexpr int kFormatWithTours = 4, kFormatWithPlans = 5;

void code_finite(RecordBytes& bytes, double& value, const char* what) {
  bytes.number(value);
  bytes.require(std::isfinite(value), what);
}

void code_length(RecordBytes& bytes, double& value, const char* what) {
  bytes.number(value);
  bytes.require(std::isfinite(value) && value >= 0.0, what);
}

void code_pose(RecordBytes& bytes, Pose& pose) {
  for (double* number : {&pose.position.x(), &pose.position.y(), &pose.position.z(), &pose.yaw})
    code_finite(bytes, *number, "a pose is not finite");
  constexpr double kFarthest = 1e9;  // [m], as of meshes
  bytes.require(pose.position.array().abs().maxCoeff() <= kFarthest, "a pose is more than 1e9 m away");
}

void code_keys(RecordBytes& bytes, std::vector<VoxelKey>& keys) {
  bytes.length(keys, kKeyBytes);
  bytes.keys(keys);
}

void code_sorted_keys(RecordBytes& bytes, std::vector<VoxelKey>& keys, const char* what) {
  code_keys(bytes, keys);
  bytes.require(std::ranges::adjacent_find(keys, std::greater_equal<>()) == keys.end(), what);
}

void code_box(RecordBytes& bytes, KeyBox& box) {
  bytes.key(box.min);
  bytes.key(box.max);
}

template <class Check>
bool passes(const Check& check) {
  try {
    check();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

void code_view(RecordBytes& bytes, FieldOfView& view) {
  bytes.whole(view.shape, "shape of view", FieldOfView::Shape::kCone);
  bytes.number(view.horizontal);
  bytes.number(view.vertical);
  bytes.number(view.max_range);
  bytes.require(
      std::isfinite(view.horizontal) && std::isfinite(view.vertical) && passes([&] { view.check(); }),
      "the field of view is out of bounds");
}

// Motion and shape as one number, `motion + 3 shape`: that of a box is its motion, as before there were
// shapes.
void code_motion_and_shape(RecordBytes& bytes, TravelOptions& travel) {
  constexpr int kMotions = static_cast<int>(Motion::kGround) + 1,
                kShapes = static_cast<int>(BodyShape::kSphere) + 1;
  int pair = static_cast<int>(travel.motion) + kMotions * static_cast<int>(travel.shape);
  bytes.whole(pair, "motion and shape of the body", kMotions * kShapes - 1);
  travel.motion = static_cast<Motion>(pair % kMotions);
  travel.shape = static_cast<BodyShape>(pair / kMotions);
}

void code_travel(RecordBytes& bytes, TravelOptions& travel) {
  constexpr std::uint64_t kMostReach = 0xFFFF;  // [voxels]
  code_motion_and_shape(bytes, travel);
  for (double& extent : travel.extents) code_length(bytes, extent, "an extent of the body is no length");
  const auto unlike = axis_unlike_x(travel);
  bytes.require(unlike != 1, "the body is round, but not as long as wide");
  bytes.require(unlike != 2, "the body is a sphere, but not as high as wide");
  bytes.whole(travel.metric, "path metric", PathMetric::kSteps);
  code_length(bytes, travel.margin, "the margin around the body is no length");
  code_finite(bytes, travel.sensor_height, "the sensor's height is not finite");
  bytes.whole(travel.require_ground, "a flag", 1);
  bytes.maybe(travel.ground_extents, [&](Eigen::Vector2d& extents) {
    for (double& extent : extents) code_length(bytes, extent, "a ground extent is no length");
  });
  bytes.whole(travel.ground_reach, "ground reach", kMostReach);
  bytes.length(travel.without_ground, 2 * kKeyBytes);
  for (KeyBox& box : travel.without_ground) code_box(bytes, box);
  code_finite(bytes, travel.floor, "the floor's height is not finite");
  code_finite(bytes, travel.min_height, "the least height is not finite");
  code_length(bytes, travel.node_edge, "the edge of the nodes is no length");
  if (travel.motion != Motion::kGround) return;
  code_length(bytes, travel.step, "the highest step is no length");
  code_finite(bytes, travel.slope, "the steepest slope is not finite");
}

void code_limits(RecordBytes& bytes, MotionLimits& limits) {
  for (double* limit : {&limits.speed, &limits.acceleration, &limits.yaw_rate}) bytes.number(*limit);
  bytes.whole(limits.per_axis, "a flag", 1);
  bytes.require(passes([&] { limits.check(); }), "a limit of the motion is out of bounds");
}

void code_description(RecordBytes& bytes, RobotDescription& description) {
  constexpr std::size_t kMostRays = 100'000'000;  // in a scan
  bytes.text(description.robot.name);
  code_travel(bytes, description.robot.travel);
  code_view(bytes, description.robot.view);
  code_limits(bytes, description.robot.limits);
  bytes.number(description.rate);
  bytes.require(std::isfinite(description.rate) && description.rate > 0.0, "scans have no finite rate");
  bytes.whole(description.columns);
  bytes.whole(description.rows);
  bytes.require(description.columns > 0 && description.rows > 0 && description.columns <= kMostRays &&
                    description.rows <= kMostRays / description.columns,
                "a scan has no rays, or more than 100 million");
}

void code_head(RecordBytes& bytes, RecordingHead& head) {
  bytes.text(head.world);
  bytes.number(head.resolution);
  bytes.require(passes([&] { static_cast<void>(Lattice(head.resolution)); }),
                "the resolution is no edge of a voxel");
  code_box(bytes, head.bounds);
  bytes.require(head.bounds.contains(head.bounds.min) && head.bounds.contains(head.bounds.max),
                "the bounds are empty");
  bytes.whole(head.observable);
  bytes.whole(head.bounding);
  bytes.require(head.observable == 0 || head.bounding == 0 || head.observable <= head.bounding,
                "more voxels can be known than the bounds hold");
  bytes.text(head.options);
  bytes.require(head.options.size() <= kMostOptionBytes, "the options take more than 16 MiB");
  bytes.length(head.robots, 0, kMostRecordedRobots, "there are more than 1,000 robots");
  for (std::size_t i = 0; i < head.robots.size(); ++i) {
    bytes.part("robot " + std::to_string(i));
    code_description(bytes, head.robots[i]);
  }
  bytes.part("starts");
  bytes.length(head.starts, head.robots.size(), head.robots.size(), "there is not one for each robot");
  for (ExplorationStart& start : head.starts) {
    code_pose(bytes, start.pose);
    code_keys(bytes, start.known_free);
  }
}

// The states before and after as one number, `3 before + after`.
void code_states(RecordBytes& bytes, VoxelChange& change) {
  constexpr int kStates = static_cast<int>(Occupancy::kOccupied) + 1;
  int pair = kStates * static_cast<int>(change.before) + static_cast<int>(change.after);
  bytes.whole(pair, "change of a voxel", kStates * kStates - 1);
  change.before = static_cast<Occupancy>(pair / kStates);
  change.after = static_cast<Occupancy>(pair % kStates);
  bytes.require(change.before != change.after, "a voxel changes to what it is");
}

void code_changes(RecordBytes& bytes, std::vector<VoxelChange>& changes, const KeyBox& bounds) {
  bytes.length(changes, kKeyBytes + 1);
  bytes.keys(changes, &VoxelChange::key);
  for (VoxelChange& change : changes) {
    code_states(bytes, change);
    bytes.require(bounds.contains(change.key), "a voxel outside the bounds changes");
  }
  bytes.require(
      std::ranges::adjacent_find(changes, std::greater_equal<>(), &VoxelChange::key) == changes.end(),
      "the changes are not sorted by key, each voxel once");
}

void code_image(RecordBytes& bytes, std::vector<RenderedCell>& image) {
  bytes.length(image, kKeyBytes + 5 * sizeof(double) + 1);
  bytes.keys(image, &RenderedCell::cell);
  for (const auto column : {&RenderedCell::distance, &RenderedCell::gain, &RenderedCell::standard_error,
                            &RenderedCell::quality, &RenderedCell::yaw}) {
    bytes.numbers(image, column);
    for (const RenderedCell& cell : image)
      bytes.require(std::isfinite(cell.*column), "a number of a rendered cell is not finite");
  }
  for (RenderedCell& cell : image) bytes.whole(cell.hits, "hits of a rendered cell", 0xFFFF'FFFF);
}

void code_goal(RecordBytes& bytes, Goal& goal) {
  bytes.whole(goal.state, "state of the goal", GoalState::kNothingVisible);
  bytes.maybe(goal.pose, [&](Pose& pose) { code_pose(bytes, pose); });
  bytes.require(goal.pose.has_value() == (goal.state <= GoalState::kUncovered),
                "there is a goal, but its state says that there is none, or the other way round");
  bytes.key(goal.cell);
  bytes.text(goal.reason);
  for (double* number : {&goal.distance, &goal.gain, &goal.standard_error, &goal.quality})
    code_finite(bytes, *number, "a number of the goal is not finite");
  for (std::size_t* count : {&goal.assigned, &goal.released, &goal.received, &goal.uncovered})
    bytes.whole(*count);
}

void code_tour(RecordBytes& bytes, std::vector<PlannedStop>& tour) {
  bytes.length(tour, 4 * sizeof(double) + 2);
  for (PlannedStop& stop : tour) {
    code_pose(bytes, stop.pose);
    bytes.whole(stop.clusters);
    bytes.whole(stop.frontiers);
  }
}

void code_robot(RecordBytes& bytes, RobotStep& robot, const KeyBox& bounds, int format) {
  bytes.whole(robot.gain_tangent);
  bytes.whole(robot.gain_predicted);
  bytes.whole(robot.gain_sum);
  bytes.whole(robot.gained);
  bytes.whole(robot.travelled);
  code_length(bytes, robot.length, "what it travelled is no length");
  bytes.whole(robot.path, "outcome of the path search", PathOutcome::kOutOfReach);
  code_goal(bytes, robot.goal);
  bytes.length(robot.planned, 4 * sizeof(double));
  bytes.require(robot.travelled <= robot.planned.size(), "it reached more viewpoints than were planned");
  for (Pose& pose : robot.planned) code_pose(bytes, pose);
  code_changes(bytes, robot.changed, bounds);
  code_sorted_keys(bytes, robot.still_unknown, "the voxels still unknown are not sorted, each once");
  code_sorted_keys(bytes, robot.blocked, "the blocked cells are not sorted, each once");
  code_image(bytes, robot.image);
  if (format >= kFormatWithTours) code_tour(bytes, robot.tour);
  if (format < kFormatWithPlans) return;
  bytes.length(robot.trajectory, 4 * sizeof(double));
  for (Pose& pose : robot.trajectory) code_pose(bytes, pose);
  code_sorted_keys(bytes, robot.reassigned, "the reassigned frontiers are not sorted, each once");
}

void code_known(RecordBytes& bytes, std::vector<KnownVoxels>& known, const RecordingHead& head) {
  bytes.length(known, head.robots.size(), head.robots.size(), "there is not one number for each robot");
  std::uint64_t observable_left = head.observable, bounding_left = head.bounding;
  for (KnownVoxels& part : known) {
    bytes.whole(part.observable);
    bytes.whole(part.bounding);
    bytes.require(head.observable == 0 || part.observable <= observable_left,
                  "more voxels than can be known are");
    bytes.require(head.bounding == 0 || part.bounding <= bounding_left,
                  "more voxels are known than the bounds hold");
    observable_left -= part.observable;
    bounding_left -= part.bounding;
  }
}

void code_step(RecordBytes& bytes, RecordedStep& recorded, const RecordingHead& head, std::uint64_t number,
               int format) {
  const std::string name = "step " + std::to_string(number);
  ExplorationStep& step = recorded.step;
  bytes.part(name);
  bytes.whole(step.number);
  bytes.require(step.number == number, "has another number");
  bytes.whole(step.frontiers);
  bytes.whole(step.unassigned);
  bytes.whole(step.abandoned);
  bytes.require(step.unassigned <= step.frontiers && step.abandoned <= step.frontiers,
                "more frontiers are unassigned or abandoned than there are");
  bytes.whole(step.rays);
  bytes.whole(recorded.contacts);
  code_length(bytes, step.time, "a step ends at no finite time");
  for (double& seconds : step.seconds) code_length(bytes, seconds, "a phase takes no finite time");
  bytes.part(name + ", known voxels");
  code_known(bytes, recorded.known, head);
  bytes.part(name);
  bytes.length(step.robots, head.robots.size(), head.robots.size(), "has not as many robots as the team");
  for (std::size_t i = 0; i < step.robots.size(); ++i) {
    bytes.part(name + ", robot " + std::to_string(i));
    code_robot(bytes, step.robots[i], head.bounds, format);
  }
}

void code_end(RecordBytes& bytes, std::string& reason) {
  constexpr std::size_t kLongest = 40;
  bytes.text(reason);
  bytes.require(!reason.empty() && reason.size() <= kLongest &&
                    reason.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos,
                "the reason of the end is not one word of small letters");
}

// Takes a copy, since `code` could also read into it.
template <class Value, class Code>
std::string write_with(Value value, const Code& code) {
  RecordBytes bytes;
  code(bytes, value);
  return bytes.written();
}

template <class Value, class Code>
Value read_with(std::string_view from, const Code& code) {
  RecordBytes bytes(from);
  Value value;
  code(bytes, value);
  bytes.end();
  return value;
}

auto code_step_of(const RecordingHead& head, std::uint64_t number, int format) {
  return [&head, number, format](RecordBytes& bytes, RecordedStep& step) {
    code_step(bytes, step, head, number, format);
  };
}

}  // namespace

std::string head_bytes(const RecordingHead& head) { return write_with(head, code_head); }
RecordingHead head_from(std::string_view bytes) { return read_with<RecordingHead>(bytes, code_head); }

std::string step_bytes(const RecordedStep& step, const RecordingHead& head, std::uint64_t number,
                       int format) {
  return write_with(step, code_step_of(head, number, format));
}
RecordedStep step_from(std::string_view bytes, const RecordingHead& head, std::uint64_t number, int format) {
  return read_with<RecordedStep>(bytes, code_step_of(head, number, format));
}

std::string end_bytes(const std::string& reason) { return write_with(reason, code_end); }
std::string end_from(std::string_view bytes) { return read_with<std::string>(bytes, code_end); }

}  // namespace frontlux::planner::detail
