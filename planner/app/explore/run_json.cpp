#include "explore/run_json.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <numeric>
#include <ostream>
#include <thread>

namespace frontlux::app {
namespace {

// "render", or the rules of all robots with + between them.
std::string goal_rules(const std::vector<planner::TeamMember>& team) {
  std::string names;
  for (const auto& rule : kChoices<planner::GoalRule>)
    if (std::any_of(team.begin(), team.end(),
                    [&](const planner::TeamMember& member) { return member.options.rule == rule.value; }))
      names.append(names.empty() ? "" : "+").append(rule.name);
  return names;
}

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

}  // namespace

void write_run_json(const ExploreRun& run, const ExploreOptions& options, const ExploreSetup& setup,
                    const RunSums& sums, const std::string& end, double seconds) {
  using Json = nlohmann::ordered_json;
  const planner::ExplorationOptions& exploration = setup.exploration;
  Json names = Json::array(), phases = Json::object(), lengths = Json::object();
  for (std::size_t r = 0; r < setup.head.robots.size(); ++r) {
    const std::string& name = setup.head.robots[r].robot.name;
    names.push_back(name);
    lengths[name] = sums.travelled[r];
  }
  for (std::size_t phase = 0; phase < planner::kPhases; ++phase)
    phases[std::string(planner::name_of(static_cast<planner::Phase>(phase)))] = sums.seconds[phase];
  const Json json = {
      {"version", FRONTLUX_VERSION},
      {"world", setup.head.world},
      {"seed", exploration.seed},
      {"robots", names},
      {"mode", choice_name(options.mode)},
      {"goal", goal_rules(exploration.team)},
      {"assign", exploration.assign},
      {"optimize", exploration.optimize},
      {"caster", choice_name(options.caster)},
      {"planner", planner::name_of(exploration.path.search)},
      {"resolution_m", setup.head.resolution},
      {"max_steps", exploration.max_steps},
      {"epsilon", exploration.epsilon},
      {"threads", run.threads},
      {"machine", machine_name()},
      {"instructions", instruction_set_name()},
      {"end", end},
      {"steps", sums.steps},
      {"coverage_observable", sums.observable},
      {"coverage_box", sums.bounding},
      {"planning_mean_s", sums.planning_mean()},
      {"planning_max_s", sums.planning_max},
      {"phases_s", phases},
      {"collisions", sums.collisions},
      {"path_length_total_m", std::accumulate(sums.travelled.begin(), sums.travelled.end(), 0.0)},
      {"path_length_m", lengths},
      {"held_back", sums.held_back},
      {"wall_s", seconds},
      {"memory_mb", peak_memory_mb()},
      {"options", to_json(options)},
  };
  // File names are bytes, JSON is Unicode.
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  write_file(run.folder / "run.json", [&](std::ostream& out) { out << text; });
}

}  // namespace frontlux::app
