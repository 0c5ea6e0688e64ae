#include "parts.hpp"

#include <frontlux/report/robot_colors.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frontlux::report::detail {
namespace {

using nlohmann::json;

constexpr std::size_t kMostWarnings = 100;  // a page shows them all

json numbers_of(const planner::Pose& pose) {
  return {pose.position.x(), pose.position.y(), pose.position.z(), pose.yaw};
}

json facts_of(const planner::RobotDescription& description) {
  constexpr std::array kShapes = {"spinning", "pyramid", "cone"};
  const planner::Robot& robot = description.robot;
  const Eigen::Vector3d& extents = robot.travel.extents;
  return {{"name", robot.name},
          {"plane", robot.travel.drives()},
          {"extents", {extents.x(), extents.y(), extents.z()}},
          {"sensor_height", robot.mount_height()},
          {"shape", kShapes.at(static_cast<std::size_t>(robot.view.shape))},
          {"horizontal", robot.view.horizontal},
          {"vertical", robot.view.vertical},
          {"max_range", robot.view.max_range},
          {"columns", description.columns},
          {"rows", description.rows}};
}

json facts_of(const planner::RobotStep& robot) {
  const planner::Goal& goal = robot.goal;
  json facts = {{"state", name_of(goal.state)}, {"reason", goal.reason},
                {"path", describe(robot.path)}, {"gain_predicted", robot.gain_predicted},
                {"gained", robot.gained},       {"length", robot.length}};
  if (goal.pose) facts["goal"] = numbers_of(*goal.pose);
  return facts;
}

json facts_of(const planner::RecordedStep& recorded) {
  const planner::ExplorationStep& step = recorded.step;
  json facts = {{"number", step.number},         {"time", step.time},           {"frontiers", step.frontiers},
                {"unassigned", step.unassigned}, {"abandoned", step.abandoned}, {"rays", step.rays},
                {"seconds", step.seconds},       {"known", json::array()},      {"robots", json::array()},
                {"contacts", recorded.contacts}};
  for (const planner::KnownVoxels& known : recorded.known)
    facts["known"].push_back(json::array({known.observable, known.bounding}));
  for (const planner::RobotStep& robot : step.robots) facts["robots"].push_back(facts_of(robot));
  return facts;
}

json numbers_of(const VoxelKey& key) { return {key.x, key.y, key.z}; }

// A member of an object, or null. Nothing is copied: what is nested deeply would take all of the stack.
const json& member(const json& object, std::string_view name) {
  static const json kNothing;
  const auto found = object.find(name);
  return found == object.end() ? kNothing : *found;
}

bool is_number_or_null(const json& value) { return value.is_number() || value.is_null(); }

json number_in(const json& object, const char* name) {
  const json& number = member(object, name);
  return number.is_number() ? number : json();
}

json numbers_in(const json& object, std::initializer_list<const char*> names) {
  json numbers = json::object();
  for (const char* name : names) numbers[name] = number_in(object, name);
  return numbers;
}

// What run.json says besides the recording; null if there is none of this recording.
json measured_of(const std::string& run_json, const planner::Recording& recording) {
  if (run_json.empty() || !misfit(run_json, recording).empty()) return nullptr;
  const json all = json::parse(run_json, nullptr, false);
  json measured =
      numbers_in(all, {"clearance_min_m", "separation_min_m", "contacts_in_free", "surface_out_of_bounds"});
  measured["unseen"] = numbers_in(member(all, "unseen"), {"in_view", "narrow", "hidden"});
  measured["map"] = numbers_in(member(all, "map"), {"false_free", "false_occupied", "surface_found"});
  measured["warnings"] = json::array();
  if (const json& warnings = member(all, "warnings"); warnings.is_array())
    for (const json& warning : warnings)
      if (warning.is_string() && measured["warnings"].size() < kMostWarnings)
        measured["warnings"].push_back(warning);
  for (const planner::RobotDescription& description : recording.head.robots) {
    const std::string name = unicode_of(description.robot.name);
    const json& robot = member(member(all, "by_robot"), name);
    json numbers = numbers_in(robot, {"idle_s", "held_back"});
    numbers.update(numbers_in(member(member(all, "unseen_why"), name),
                              {"narrow_by_m", "in_view_then", "without_min_height"}));
    const json& goal = member(robot, "goal");
    numbers["goal"] = goal.is_string() ? goal : json("");
    measured["robots"].push_back(std::move(numbers));
  }
  return measured;
}

}  // namespace

std::string unicode_of(const std::string& bytes) {
  return json::parse(json(bytes).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

std::string run_facts(const ReportedRun& run, const std::string& version) {
  const planner::Recording& recording = *run.recording;
  const planner::RecordingHead& head = recording.head;
  json facts = {{"name", run.name},
                {"written_by", version},
                {"world", head.world},
                {"resolution", head.resolution},
                {"bounds", {numbers_of(head.bounds.min), numbers_of(head.bounds.max)}},
                {"observable", head.observable},
                {"bounding", head.bounding},
                {"options", head.options},  // as text: it need not be the JSON that it should be
                {"end", nullptr},
                {"measured", measured_of(run.run_json, recording)},
                {"truncated", recording.truncated}};
  if (recording.end) facts["end"] = *recording.end;
  for (std::size_t phase = 0; phase < planner::kPhases; ++phase)
    facts["phases"].push_back(name_of(static_cast<planner::Phase>(phase)));
  const std::vector<ColorPair> colors = robot_colors(head.robots);
  for (std::size_t i = 0; i < head.robots.size(); ++i) {
    facts["robots"].push_back(facts_of(head.robots[i]));
    facts["robots"][i]["colors"] = {std::string(colors[i].light), std::string(colors[i].dark)};
    if (i < head.starts.size()) facts["robots"][i]["start"] = numbers_of(head.starts[i].pose);
  }
  for (const planner::RecordedStep& step : recording.steps) facts["steps"].push_back(facts_of(step));
  return facts.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace frontlux::report::detail

namespace frontlux::report {

using namespace detail;

std::string misfit(const std::string& run_json, const planner::Recording& recording) {
  if (run_json.empty()) return {};
  const json all = json::parse(run_json, nullptr, false);
  if (!all.is_object()) return "is damaged: it holds no JSON object";
  if (!recording.end || recording.steps.empty()) return "is older than the recording, which has no end";
  json robots = json::array();
  for (const planner::RobotDescription& description : recording.head.robots)
    robots.push_back(unicode_of(description.robot.name));
  for (const auto& [name, recorded] :
       {std::pair<const char*, json>("world", unicode_of(recording.head.world)),
        {"robots", robots},
        {"end", *recording.end},
        {"steps", recording.steps.back().step.number}})
    if (member(all, name) != recorded)
      return std::string("does not fit the recording: ") + name + " is not " +
             recorded.dump(-1, ' ', true, json::error_handler_t::replace);
  std::uint64_t mapped = 0;
  for (const planner::KnownVoxels& known : recording.steps.back().known) mapped += known.observable;
  const json& coverage = member(all, "coverage_observable");
  const double all_there = static_cast<double>(recording.head.observable);
  if (all_there > 0.0 && coverage.is_number() &&
      std::abs(coverage.get<double>() - static_cast<double>(mapped) / all_there) > 1e-9)
    return "does not fit the recording: coverage_observable is not " +
           std::to_string(static_cast<double>(mapped) / all_there);
  bool whole = true;
  const auto check = [&](const json& object, const char* name) {
    whole = whole && is_number_or_null(member(object, name));
  };
  for (const char* name : {"clearance_min_m", "separation_min_m"}) check(all, name);
  for (const json& robot : robots)
    for (const char* name : {"idle_s", "held_back"})
      check(member(member(all, "by_robot"), robot.get_ref<const std::string&>()), name);
  return whole ? "" : "is damaged: a clearance, a separation or a robot's numbers are no numbers";
}

}  // namespace frontlux::report
