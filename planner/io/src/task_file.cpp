#include "members.hpp"
#include "robot_members.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/robot_file.hpp>
#include <frontlux/io/task_file.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

namespace frontlux::io {
namespace {

using nlohmann::json, nlohmann::ordered_json;
using planner::Pose;

constexpr std::size_t kTaskDepth = 6;  // of what may hold it, task, robots, robot, body, size
constexpr std::size_t kLongestName = 255;
constexpr JsonContent kTask{"a task", "docs/tasks.md", kTaskDepth};

const std::string kSeeTasks = "an object, see docs/tasks.md";

std::string read_name(Members& members, std::string otherwise) {
  const json* value = members.find("name");
  if (value == nullptr) return otherwise;
  const std::string wanted = "1 to " + std::to_string(kLongestName) + " characters on one line";
  if (!value->is_string()) members.refuse_value("name", *value, wanted);
  auto name = value->get<std::string>();
  const bool fits = !name.empty() && name.size() <= kLongestName &&
                    std::ranges::none_of(name, [](unsigned char c) { return c < ' ' || c == 0x7F; });
  if (!fits) members.refuse_value("name", *value, wanted);
  return name;
}

Eigen::AlignedBox3d read_box(const Members& members, const json& value) {
  const std::string wanted = "the lowest and the highest corner, as in [[-5, -5, 0], [5, 5, 3]]";
  if (!value.is_array() || value.size() != 2) members.refuse_value("box_m", value, wanted);
  std::array<Eigen::Vector3d, 2> corners;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto numbers =
        members.numbers(Members::element("box_m", i), value[i], 3, wanted, "m", kCoordinates);
    corners[i] = {numbers[0], numbers[1], numbers[2]};
  }
  if (!((corners[1] - corners[0]).minCoeff() > 0.0))
    members.refuse("box_m",
                   "is " + value.dump() + ", where not every number of the first corner is the lower one",
                   "give " + wanted);
  return {corners[0], corners[1]};
}

TaskMethod read_method(const Members& members, const json& value) {
  const std::string word = value.is_string() ? value.get<std::string>() : "";
  if (word == name_of(TaskMethod{})) return {};
  if (const auto search = planner::goal_search(word)) return {search};
  std::string wanted;
  for (const auto& [name, search] : planner::kGoalSearchNames)
    wanted.append(wanted.empty() ? "\"" : "\", \"").append(name);
  members.refuse_value("method", value, wanted.append("\" or \"").append(name_of(TaskMethod{})).append("\""));
}

void read_end(Members members, Task& task) {
  if (const json* coverage = members.find("coverage"))
    task.end_coverage = members.number("coverage", *coverage, "of the observable space", {0.0, 1.0});
  if (const json* time = members.find("time_s"))
    task.end_time = members.number("time_s", *time, "s", kFromZero);
  members.expect_no_more();
}

Pose read_start(const Members& members, const json& value, const std::optional<Eigen::AlignedBox3d>& box) {
  const std::string wanted = "x, y and z in metres and the yaw in degrees, as in [1, 0, 1, 90]";
  const auto numbers =
      members.numbers("start", value, 4, wanted, "(metres, and degrees of yaw)", kCoordinates);
  const Pose pose{{numbers[0], numbers[1], numbers[2]}, numbers[3] * kDegree};
  if (box && !box->contains(pose.position))
    members.refuse("start", "is " + value.dump() + ", outside of box_m",
                   "give a start in the box, or a larger box");
  return pose;
}

TaskRobot read_robot_of_task(const std::filesystem::path& file, const json& value, const std::string& name,
                             const std::optional<Eigen::AlignedBox3d>& box) {
  Members members(file, value, name + ".");
  TaskRobot robot;
  if (members.find("file") != nullptr) {
    const std::string wanted = "the name of a robot's file, relative to the task's folder";
    const std::string other = members.text("file", wanted);
    if (other.empty()) members.refuse("file", "is ''", "give " + wanted);
    try {
      robot.description = read_robot(file.parent_path() / other);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(file.string() + ": " + name + ".file: " + error.what());
    }
  } else {
    robot.description = read_robot_members(members, RobotForm::kTask);
  }
  if (const json* start = members.find("start")) robot.start = read_start(members, *start, box);
  members.expect_no_more();
  return robot;
}

std::vector<TaskRobot> read_robots(const std::filesystem::path& file, const json& value,
                                   const std::optional<Eigen::AlignedBox3d>& box) {
  const std::string wanted = "an array of 1 to " + std::to_string(kMostRobots) + " robots, see docs/tasks.md";
  const auto refuse = [&](const std::string& name, const json& wrong, const std::string& right) {
    fail(file, name + " is " + Members::shown(wrong), "give " + right);
  };
  if (!value.is_array() || value.empty() || value.size() > kMostRobots) refuse("robots", value, wanted);
  std::vector<TaskRobot> robots;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::string name = Members::element("robots", i);
    if (!value[i].is_object()) refuse(name, value[i], kSeeTasks);
    robots.push_back(read_robot_of_task(file, value[i], name, box));
  }
  return robots;
}

void read_options(const Members& members, const json& object, Task& task) {
  for (const auto& [name, value] : object.items()) {
    if (!value.is_string() && !value.is_number())
      members.refuse_value(name, value, "what is written on the command line, as a string or a number");
    task.options.emplace_back(name, value.is_string() ? value.get<std::string>() : value.dump());
  }
}

ordered_json json_of_robot(const TaskRobot& robot) {
  ordered_json object = json_of(robot.description);
  if (robot.start) {
    const Eigen::Vector3d& at = robot.start->position;
    object["start"] = {at.x(), at.y(), at.z(), degrees_of(robot.start->yaw)};
  }
  return object;
}

ordered_json json_of_robots(std::span<const TaskRobot> robots) {
  ordered_json array = ordered_json::array();
  for (const TaskRobot& robot : robots) array.push_back(json_of_robot(robot));
  return array;
}

std::string dumped(const ordered_json& object) {
  return object.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

std::string_view name_of(const TaskMethod& method) {
  return method.goal ? planner::name_of(*method.goal) : "paper";
}

Task read_task(const std::filesystem::path& file) {
  const json object = read_json(file, kTask);
  if (object.contains("task") && object.contains("version"))
    fail(file, "holds the results of a run", "save its member task alone, see docs/tasks.md");
  Members members(file, object);
  Task task;
  task.name = read_name(members, file.stem().string());
  task.world = members.text("world", "a file relative to the task's folder, or the name of a built-in world");
  const auto seed = [&](const char* name, std::optional<std::uint64_t>& number) {
    if (members.find(name) != nullptr)
      number = members.whole(name, 0, std::numeric_limits<std::uint64_t>::max());
  };
  seed("world_seed", task.world_seed);
  if (const json* box = members.find("box_m")) task.box = read_box(members, *box);
  if (const json* edge = members.find("resolution_m"))
    task.resolution = members.number("resolution_m", *edge, "m", {0.001, 1000.0});
  seed("seed", task.seed);
  if (const json* latency = members.find("latency_s"))
    task.latency = members.number("latency_s", *latency, "s", {kAboveZero.low, kMostLatency});
  if (members.find("lockstep") != nullptr) task.lockstep = members.flag("lockstep", false);
  if (const json* method = members.find("method")) task.method = read_method(members, *method);
  if (const json* end = members.find("end")) read_end(members.object("end", *end, kSeeTasks), task);
  if (members.find("team") != nullptr)
    task.team = members.text("team", "robots joined by +, as in \"uav+ugv\"");
  if (const json* robots = members.find("robots")) {
    if (task.team) members.refuse("team", "is for a task without robots", "leave one of them out");
    task.robots = read_robots(file, *robots, task.box);
  }
  if (const json* options = members.find("options"))
    read_options(members.object("options", *options, kSeeTasks), *options, task);
  members.expect_no_more();
  return task;
}

std::string task_text(const Task& task) {
  ordered_json object;
  object["name"] = task.name;
  object["world"] = task.world;
  if (task.world_seed) object["world_seed"] = *task.world_seed;
  if (task.box) {
    const Eigen::Vector3d &low = task.box->min(), &high = task.box->max();
    object["box_m"] = {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
  }
  const auto add = [&](const char* name, const auto& value) {
    if (value) object[name] = *value;
  };
  add("resolution_m", task.resolution);
  add("seed", task.seed);
  add("latency_s", task.latency);
  add("lockstep", task.lockstep);
  if (task.method) object["method"] = name_of(*task.method);
  if (task.end_coverage) object["end"]["coverage"] = *task.end_coverage;
  if (task.end_time) object["end"]["time_s"] = *task.end_time;
  add("team", task.team);
  if (!task.robots.empty()) object["robots"] = json_of_robots(task.robots);
  for (const auto& [name, word] : task.options) object["options"][name] = word;
  return dumped(object);
}

std::string robots_text(std::span<const TaskRobot> robots) { return dumped(json_of_robots(robots)); }

std::vector<TaskRobot> robots_of(const std::string& text) {
  const std::filesystem::path recorded = "recorded robots";
  return read_robots(recorded, parse_json(recorded, text, kTask), std::nullopt);
}

}  // namespace frontlux::io
