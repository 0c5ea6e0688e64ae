#include "run_facts.hpp"

#include "json_text.hpp"

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace frontlux::report::detail {
namespace {

void add_numbers(JsonText& json, std::string_view name, std::initializer_list<double> numbers) {
  json.name(name).open('[');
  for (const double number : numbers) json.number(number);
  json.close(']');
}

void add_pose(JsonText& json, std::string_view name, const planner::Pose& pose) {
  add_numbers(json, name, {pose.position.x(), pose.position.y(), pose.position.z(), pose.yaw});
}

void add_robot(JsonText& json, const planner::RobotDescription& description, const planner::Pose* start) {
  constexpr std::array<std::string_view, 3> kShapes = {"spinning", "pyramid", "cone"};
  const planner::Robot& robot = description.robot;
  json.open('{').name("name").text(robot.name);
  json.name("plane").yes(robot.travel.motion == planner::Motion::kPlane);
  add_numbers(json, "extents",
              {robot.travel.extents.x(), robot.travel.extents.y(), robot.travel.extents.z()});
  json.name("sensor_height").number(robot.mount_height());
  json.name("shape").text(kShapes.at(static_cast<std::size_t>(robot.view.shape)));
  json.name("horizontal").number(robot.view.horizontal);
  json.name("vertical").number(robot.view.vertical);
  json.name("max_range").number(robot.view.max_range);
  json.name("columns").number(std::uint64_t{description.columns});
  json.name("rows").number(std::uint64_t{description.rows});
  if (start != nullptr) add_pose(json, "start", *start);
  json.close('}');
}

void add_robot_step(JsonText& json, const planner::RobotStep& robot) {
  const planner::Goal& goal = robot.goal;
  json.open('{').name("state").text(name_of(goal.state)).name("reason").text(goal.reason);
  if (goal.pose) {
    add_pose(json, "goal", *goal.pose);
    json.name("distance").number(goal.distance).name("gain").number(goal.gain);
    json.name("standard_error").number(goal.standard_error).name("quality").number(goal.quality);
  }
  json.name("assigned").number(std::uint64_t{goal.assigned});
  json.name("released").number(std::uint64_t{goal.released});
  json.name("received").number(std::uint64_t{goal.received});
  json.name("left_over").number(std::uint64_t{goal.left_over});
  json.name("path").text(describe(robot.path));
  json.name("gain_tangent").number(robot.gain_tangent).name("gain_predicted").number(robot.gain_predicted);
  json.name("gained").number(robot.gained).name("length").number(robot.length);
  json.name("still_unknown").number(std::uint64_t{robot.still_unknown.size()}).close('}');
}

void add_step(JsonText& json, const planner::RecordedStep& recorded) {
  const planner::ExplorationStep& step = recorded.step;
  json.open('{').name("number").number(step.number);
  json.name("frontiers").number(std::uint64_t{step.frontiers});
  json.name("unassigned").number(std::uint64_t{step.unassigned});
  json.name("abandoned").number(std::uint64_t{step.abandoned});
  json.name("rays").number(step.rays).name("collisions").number(recorded.collisions);
  json.name("seconds").open('[');
  for (const double seconds : step.seconds) json.number(seconds);
  json.close(']').name("known").open('[');
  for (const planner::KnownVoxels& known : recorded.known)
    json.open('[').number(known.observable).number(known.bounding).close(']');
  json.close(']').name("robots").open('[');
  for (const planner::RobotStep& robot : step.robots) add_robot_step(json, robot);
  json.close(']').close('}');
}

void add_key(JsonText& json, const VoxelKey& key) {
  json.open('[').number(std::uint64_t{key.x}).number(std::uint64_t{key.y}).number(std::uint64_t{key.z});
  json.close(']');
}

}  // namespace

std::string run_facts(const ReportedRun& run, const std::string& version) {
  const planner::Recording& recording = *run.recording;
  const planner::RecordingHead& head = recording.head;
  JsonText json;
  json.open('{').name("name").text(run.name).name("written_by").text(version);
  json.name("world").text(head.world).name("resolution").number(head.resolution);
  json.name("bounds").open('[');
  add_key(json, head.bounds.min);
  add_key(json, head.bounds.max);
  json.close(']');
  json.name("observable").number(head.observable).name("bounding").number(head.bounding);
  json.name("options").text(head.options);  // as text: it need not be the JSON that it should be
  json.name("phases").open('[');
  for (std::size_t phase = 0; phase < planner::kPhases; ++phase)
    json.text(name_of(static_cast<planner::Phase>(phase)));
  json.close(']').name("end");
  if (recording.end)
    json.text(*recording.end);
  else
    json.null();
  json.name("truncated").yes(recording.truncated);
  json.name("robots").open('[');
  for (std::size_t i = 0; i < head.robots.size(); ++i)
    add_robot(json, head.robots[i], i < head.starts.size() ? &head.starts[i].pose : nullptr);
  json.close(']').name("steps").open('[');
  for (const planner::RecordedStep& step : recording.steps) add_step(json, step);
  json.close(']').close('}');
  return json.str();
}

}  // namespace frontlux::report::detail
