#include "explore/run_json.hpp"

#include "explore/explore_run.hpp"
#include "setup/explore_setup.hpp"
#include "setup/explore_task.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/planner/goal_search.hpp>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <system_error>
#include <thread>

namespace frontlux::app {
namespace {

using Json = nlohmann::ordered_json;

// The names of all robots' searches, with + between them.
std::string goal_searches(const planner::ExplorationOptions& exploration) {
  if (exploration.tours) return std::string(name_of(planner::GoalSearch::kTour));
  std::string names;
  for (const auto& [name, search] : planner::kGoalSearchNames)
    if (std::ranges::any_of(exploration.team, [rule = rule_of(search)](const planner::TeamMember& member) {
          return member.options.rule == rule;
        }))
      names.append(names.empty() ? "" : "+").append(name);
  return names;
}

Json or_null(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

// The processor's name and the number of its threads, for people.
std::string machine_name() {
  return processor_name() + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads";
}

// Most memory that this process has held so far [MB].
double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  constexpr double kPerMegabyte = 1000.0 / 1.024;  // the kernel counts kibibytes
  return static_cast<double>(usage.ru_maxrss) / kPerMegabyte;
}

// What keeps each robot out, by its name.
Json json_of_kept_out(const sim::Unseen& unseen, std::span<const planner::RobotDescription> robots) {
  Json by_robot = Json::object();
  for (std::size_t r = 0; r < unseen.robots.size(); ++r) {
    const sim::KeptOut& kept = unseen.robots[r];
    by_robot[robots[r].robot.name] = {{"narrow_by_m", or_null(kept.narrow_by)},
                                      {"in_view_then", kept.in_view_then},
                                      {"without_min_height", kept.without_min_height}};
  }
  return by_robot;
}

}  // namespace

std::string write_run_json(const ExploreRun& run, const ExploreOptions& options, const ExploreSetup& setup,
                           const RunResult& result) {
  const auto& [sums, numbers, end, warnings, unseen, accuracy, seconds] = result;
  const planner::ExplorationOptions& exploration = setup.exploration;
  Json names = Json::array(), phases = Json::object(), lengths = Json::object(), robots = Json::object(),
       times = Json::object();
  for (const int part : {50, 90, 95, 99})
    if (const auto time = time_to(numbers, setup.head.observable, part / 100.0))
      times[std::to_string(part)] = *time;
  times["end"] = numbers.mapped.back().time;
  std::uint64_t held_back = 0;
  for (std::size_t r = 0; r < setup.head.robots.size(); ++r) {
    const std::string& name = setup.head.robots[r].robot.name;
    names.push_back(name);
    lengths[name] = sums.travelled[r];
    const RobotNumbers& robot = numbers.robots[r];
    const planner::Pose& start = setup.head.starts[r].pose;
    robots[name] = {{"start", {start.position.x(), start.position.y(), start.position.z(), start.yaw}},
                    {"length_m", robot.length},
                    {"revisited", robot.revisited},
                    {"idle_s", robot.idle},
                    {"held_back", robot.held_back},
                    {"goal", robot.goal}};
    if (robot.failed) robots[name]["failed_s"] = *robot.failed;
    if (robot.joined) robots[name]["joined_s"] = *robot.joined;
    held_back += robot.held_back;
  }
  for (std::size_t phase = 0; phase < planner::kPhases; ++phase)
    phases[std::string(planner::name_of(static_cast<planner::Phase>(phase)))] = sums.seconds[phase];
  const double edge = setup.head.resolution;
  const auto volume = static_cast<double>(numbers.mapped.back().bounding) * edge * edge * edge;
  const Json json = {
      {"version", FRONTLUX_VERSION},
      {"world", setup.head.world},
      {"seed", exploration.seed},
      {"robots", names},
      {"mode", choice_name(options.mode)},
      {"goal", goal_searches(exploration)},
      {"assign", exploration.assign},
      {"optimize", exploration.optimize},
      {"caster", choice_name(options.caster)},
      {"sensor_model", choice_name(setup.sensor_model)},
      {"planner", planner::name_of(exploration.path.search)},
      {"resolution_m", setup.head.resolution},
      {"max_steps", exploration.max_steps},
      {"epsilon", exploration.epsilon},
      {"threads", run.threads},
      {"machine", machine_name()},
      {"instructions", instruction_set_name()},
      {"end", end},
      {"warnings", warnings},
      {"steps", sums.steps},
      {"coverage_observable", sums.observable},
      {"coverage_box", sums.bounding},
      {"unseen",
       unseen ? Json{{"in_view", unseen->in_view}, {"narrow", unseen->narrow}, {"hidden", unseen->hidden}}
              : Json()},
      {"surface_out_of_bounds", setup.sourced.out_of_bounds},
      {"unseen_why", unseen ? json_of_kept_out(*unseen, setup.head.robots) : Json()},
      {"map",
       {{"false_free", accuracy.false_free_part()},
        {"false_occupied", accuracy.false_occupied_part()},
        {"surface_found", accuracy.surface_part()}}},
      {"lockstep", setup.lockstep},
      {"time_s", times},
      {"auc", mean_coverage(numbers, setup.head.observable)},
      {"explored_m3", volume},
      {"latency_s", exploration.latency},
      {"planning_mean_s", sums.planning_mean()},
      {"planning_p99_s", sums.planning_percentile(0.99)},
      {"planning_max_s", sums.planning_percentile(1.0)},
      {"clearance_min_m", or_null(numbers.clearance)},
      {"contacts", numbers.contacts},
      {"contacts_in_free", numbers.contacts_in_free ? Json(*numbers.contacts_in_free) : Json()},
      {"separation_min_m", or_null(numbers.separation)},
      {"by_robot", robots},
      {"phases_s", phases},
      {"path_length_total_m", std::accumulate(sums.travelled.begin(), sums.travelled.end(), 0.0)},
      {"path_length_m", lengths},
      {"held_back", held_back},
      {"wall_s", seconds},
      {"memory_mb", peak_memory_mb()},
      {"options", Json::parse(json_text(options))},
      {"task", Json::parse(task_text(options, setup))},
  };
  // File names are bytes, JSON is Unicode.
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  write_file(run.folder / kRunJson, text);
  return text;
}

std::string result_line(const std::string& run_json, const ExploreRun& run) {
  Json result = {{"folder", run.folder.string()}, {"report", nullptr}};
  if (run.report && std::filesystem::exists(report_of(run))) result["report"] = report_of(run).string();
  result.update(Json::parse(run_json));
  return result.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string read_run_json(const std::filesystem::path& folder) {
  constexpr std::uint64_t kMostBytes = 1 << 24;
  std::error_code error;
  return std::filesystem::exists(folder / kRunJson, error) ? read_file(folder / kRunJson, kMostBytes) : "";
}

std::optional<int> last_limit(const std::filesystem::path& folder) {
  try {
    const Json all = Json::parse(read_run_json(folder));
    const Json& limit = all.at("options").at("max_steps");
    if (!limit.is_number_unsigned() || limit.get<std::uint64_t>() > std::numeric_limits<int>::max())
      return std::nullopt;
    return limit.get<int>();
  } catch (const std::exception&) {  // there is none, or it is damaged
    return std::nullopt;
  }
}

}  // namespace frontlux::app
