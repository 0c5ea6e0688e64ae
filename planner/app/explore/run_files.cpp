#include "explore/run_files.hpp"

#include "explore/csv_row.hpp"
#include "explore/explore_run.hpp"
#include "explore/explore_setup.hpp"
#include "explore/explore_task.hpp"
#include "text.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/sim/ground_truth.hpp>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <functional>
#include <numeric>
#include <ostream>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace frontlux::app {
namespace {

using Json = nlohmann::ordered_json;

using planner::ExplorationStep, planner::Pose, planner::RecordedStep, planner::RobotStep;

constexpr const char* kSteps = "steps.csv";
constexpr const char* kPaths = "paths.csv";
constexpr const char* kEvents = "events.csv";
constexpr const char* kMotion = "motion.csv";
constexpr const char* kTours = "tours.csv";

std::string path_rows(const RecordedStep& recorded, const planner::RecordingHead& head) {
  std::string rows;
  for (std::size_t r = 0; r < recorded.step.robots.size(); ++r) {
    const RobotStep& robot = recorded.step.robots[r];
    for (std::size_t i = 0; i < robot.planned.size(); ++i)
      rows += csv_row(recorded.step.number, head.robots[r].robot.name, i, i < robot.travelled ? 1 : 0,
                      robot.planned[i]);
  }
  return rows;
}

// "tour", or the rules of all robots with + between them.
std::string goal_searches(const planner::ExplorationOptions& exploration) {
  if (exploration.tours) return "tour";
  using planner::GoalRule;
  std::string names;
  for (const auto& [name, rule] : {std::pair{"render", GoalRule::kViewQuality},
                                   {"cluster", GoalRule::kClusters},
                                   {"nearest", GoalRule::kNearest}})
    if (std::ranges::any_of(exploration.team, [searched = rule](const planner::TeamMember& member) {
          return member.options.rule == searched;
        }))
      names.append(names.empty() ? "" : "+").append(name);
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

double fraction(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

// What a row of steps.csv tells of: a robot in a step.
struct StepRow {
  const RecordedStep& recorded;
  const planner::RecordingHead& head;
  const RunSums& sums;  // up to the end of the step
  std::size_t r;
  const ExplorationStep& step = recorded.step;
  const RobotStep& robot = step.robots[r];

  // Empty without a goal.
  [[nodiscard]] std::string of_goal(double number) const { return robot.goal.pose ? csv_cell(number) : ""; }
  [[nodiscard]] Pose goal() const { return robot.goal.pose.value_or(Pose()); }
};

struct StepColumn {
  std::string name;
  std::function<std::string(const StepRow&)> cell;
};

std::vector<StepColumn> step_columns() {
  using Row = const StepRow&;
  std::vector<StepColumn> columns = {
      {"step", [](Row row) { return csv_cell(row.step.number); }},
      {"time_s", [](Row row) { return csv_cell(row.step.time); }},
      {"robot", [](Row row) { return csv_cell(row.head.robots[row.r].robot.name); }},
      {"coverage_observable", [](Row row) { return csv_cell(row.sums.observable); }},
      {"coverage_box", [](Row row) { return csv_cell(row.sums.bounding); }},
      {"robot_observable",
       [](Row row) { return csv_cell(fraction(row.recorded.known[row.r].observable, row.head.observable)); }},
      {"robot_box",
       [](Row row) { return csv_cell(fraction(row.recorded.known[row.r].bounding, row.head.bounding)); }},
      {"frontiers", [](Row row) { return csv_cell(row.step.frontiers); }},
      {"unassigned", [](Row row) { return csv_cell(row.step.unassigned); }},
      {"abandoned", [](Row row) { return csv_cell(row.step.abandoned); }},
      {"goal_state",
       [](Row row) {
         return csv_cell(row.step.number == 0 ? "start" : planner::name_of(row.robot.goal.state));
       }},
      {"assigned", [](Row row) { return csv_cell(row.robot.goal.assigned); }},
      {"released", [](Row row) { return csv_cell(row.robot.goal.released); }},
      {"received", [](Row row) { return csv_cell(row.robot.goal.received); }},
      {"uncovered", [](Row row) { return csv_cell(row.robot.goal.uncovered); }},
      {"goal_x_m", [](Row row) { return row.of_goal(row.goal().position.x()); }},
      {"goal_y_m", [](Row row) { return row.of_goal(row.goal().position.y()); }},
      {"goal_z_m", [](Row row) { return row.of_goal(row.goal().position.z()); }},
      {"goal_yaw_rad", [](Row row) { return row.of_goal(row.goal().yaw); }},
      {"goal_gain", [](Row row) { return row.of_goal(row.robot.goal.gain); }},
      {"path", [](Row row) { return csv_cell(planner::name_of(row.robot.path)); }},
      {"viewpoints", [](Row row) { return csv_cell(row.robot.planned.size()); }},
      {"length_m", [](Row row) { return csv_cell(row.robot.length); }},
      {"travelled_m", [](Row row) { return csv_cell(row.sums.travelled[row.r]); }},
      {"gain_tangent", [](Row row) { return csv_cell(row.robot.gain_tangent); }},
      {"gain_predicted", [](Row row) { return csv_cell(row.robot.gain_predicted); }},
      {"gained", [](Row row) { return csv_cell(row.robot.gained); }},
      {"still_unknown", [](Row row) { return csv_cell(row.robot.still_unknown.size()); }},
      {"collisions", [](Row row) { return csv_cell(row.recorded.collisions); }},
      {"rays", [](Row row) { return csv_cell(row.step.rays); }}};
  for (std::size_t phase = 0; phase < planner::kPhases; ++phase) {
    if (static_cast<planner::Phase>(phase) == planner::Phase::kMoving)
      columns.push_back({"planning_s", [](Row row) { return csv_cell(row.step.planning_seconds()); }});
    columns.push_back({std::string(planner::name_of(static_cast<planner::Phase>(phase))) + "_s",
                       [phase](Row row) { return csv_cell(row.step.seconds[phase]); }});
  }
  return columns;
}

// A line for which `cell` makes the cell of each column.
std::string step_line(const auto& cell) {
  static const std::vector<StepColumn> kColumns = step_columns();
  std::string line;
  for (const StepColumn& column : kColumns) line.append(line.empty() ? "" : ",").append(cell(column));
  return line + '\n';
}

}  // namespace

RecordedStep with_known_voxels(ExplorationStep step, const RecordedStep* before,
                               const sim::GroundTruth& truth) {
  RecordedStep recorded;
  recorded.known = before != nullptr ? before->known : std::vector<planner::KnownVoxels>(step.robots.size());
  for (std::size_t r = 0; r < step.robots.size(); ++r)
    for (const planner::VoxelChange& change : step.robots[r].changed) {
      if (change.before != Occupancy::kUnknown) continue;
      ++recorded.known[r].bounding;
      if (truth.contains(change.key)) ++recorded.known[r].observable;
    }
  recorded.step = std::move(step);
  return recorded;
}

RunFiles::RunFiles(const std::filesystem::path& folder, const planner::RecordingHead& head)
    : folder_(folder),
      head_(head),
      steps_file_(folder / kSteps, std::ios::binary | std::ios::trunc),
      paths_file_(folder / kPaths, std::ios::binary | std::ios::trunc),
      events_file_(folder / kEvents, std::ios::binary | std::ios::trunc),
      motion_file_(folder / kMotion, std::ios::binary | std::ios::trunc),
      tours_file_(folder / kTours, std::ios::binary | std::ios::trunc),
      sums_{.seconds = std::vector<double>(planner::kPhases),
            .travelled = std::vector<double>(head.robots.size())} {
  write(steps_file_, kSteps, step_line([](const StepColumn& column) { return column.name; }));
  write(paths_file_, kPaths, "step,robot,viewpoint,reached,x_m,y_m,z_m,yaw_rad\n");
  write(events_file_, kEvents,
        "time_s,step,robot,reason,goal_state,gain_predicted,begin_s,end_s,length_m,planning_s\n");
  write(motion_file_, kMotion, "time_s,robot,x_m,y_m,z_m,yaw_rad,vx_m_s,vy_m_s,vz_m_s,yaw_rate_rad_s\n");
  write(tours_file_, kTours, "time_s,step,robot,stop,x_m,y_m,z_m,yaw_rad,clusters,frontiers\n");
}

void RunFiles::add(const MotionRows& rows) {
  write(events_file_, kEvents, rows.events);
  write(motion_file_, kMotion, rows.motion);
  write(tours_file_, kTours, rows.tours);
}

void RunFiles::write(std::ofstream& file, const char* name, const std::string& rows) {
  errno = 0;
  file << rows << std::flush;
  if (!file)
    throw std::runtime_error((folder_ / name).string() + ": cannot be written: " +
                             std::generic_category().message(errno) + "; check the space left on the disk");
}

void RunFiles::add(const RecordedStep& recorded) {
  const ExplorationStep& step = recorded.step;
  std::uint64_t observable = 0, bounding = 0;
  for (const planner::KnownVoxels& known : recorded.known) {
    observable += known.observable;
    bounding += known.bounding;
  }
  sums_.observable = fraction(observable, head_.observable);
  sums_.bounding = fraction(bounding, head_.bounding);
  sums_.collisions += recorded.collisions;
  if (step.number > 0) {
    ++sums_.steps;
    sums_.planning.push_back(step.planning_seconds());
    for (std::size_t phase = 0; phase < planner::kPhases; ++phase)
      sums_.seconds[phase] += step.seconds[phase];
  }
  std::string rows;
  for (std::size_t r = 0; r < step.robots.size(); ++r) {
    sums_.travelled[r] += step.robots[r].length;
    const StepRow row{recorded, head_, sums_, r};
    rows += step_line([&](const StepColumn& column) { return column.cell(row); });
  }
  write(steps_file_, kSteps, rows);
  write(paths_file_, kPaths, path_rows(recorded, head_));
}

double RunSums::planning_mean() const {
  return planning.empty()
             ? 0.0
             : std::accumulate(planning.begin(), planning.end(), 0.0) / static_cast<double>(planning.size());
}

double RunSums::planning_percentile(double part) const {
  if (planning.empty()) return 0.0;
  std::vector<double> sorted = planning;
  std::sort(sorted.begin(), sorted.end());
  const double place = std::ceil(part * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(place, 1.0)) - 1];
}

std::optional<double> time_to(const RunNumbers& numbers, std::uint64_t observable, double part) {
  for (const Mapped& mapped : numbers.mapped)
    if (static_cast<double>(mapped.observable) >= part * static_cast<double>(observable)) return mapped.time;
  return std::nullopt;
}

double mean_coverage(const RunNumbers& numbers, std::uint64_t observable) {
  const double end = numbers.mapped.back().time;
  if (end <= 0.0) return fraction(numbers.mapped.back().observable, observable);
  double area = 0.0;
  for (std::size_t i = 1; i < numbers.mapped.size(); ++i)
    area += (numbers.mapped[i].time - numbers.mapped[i - 1].time) *
            fraction(numbers.mapped[i - 1].observable, observable);
  return area / end;
}

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
    robots[name] = {{"length_m", robot.length},
                    {"revisited", robot.revisited},
                    {"idle_s", robot.idle},
                    {"held_back", robot.held_back}};
    if (robot.failed) robots[name]["failed_s"] = *robot.failed;
    held_back += robot.held_back;
  }
  for (std::size_t phase = 0; phase < planner::kPhases; ++phase)
    phases[std::string(planner::name_of(static_cast<planner::Phase>(phase)))] = sums.seconds[phase];
  const double edge = setup.head.resolution;
  const auto volume = static_cast<double>(numbers.mapped.back().bounding) * edge * edge * edge;
  const auto or_null = [](const std::optional<double>& number) { return number ? Json(*number) : Json(); };
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
      {"collisions", sums.collisions},
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

std::filesystem::path report_of(const ExploreRun& run) { return run.folder / kReport; }

std::string result_line(const std::string& run_json, const ExploreRun& run) {
  Json result = {{"folder", run.folder.string()}, {"report", nullptr}};
  if (run.report) result["report"] = report_of(run).string();
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
    return Json::parse(read_run_json(folder)).at("options").at("max_steps").get<int>();
  } catch (const std::exception&) {  // there is none, or it is damaged
    return std::nullopt;
  }
}

}  // namespace frontlux::app
