#include "explore/run_files.hpp"

#include "explore/explore_run.hpp"
#include "explore/explore_setup.hpp"
#include "text.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/sim/ground_truth.hpp>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
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

// A line of a table with commas.
class Row {
 public:
  template <class... Cells>
  Row& add(const Cells&... cells) {
    (line_.append(line_.empty() ? "" : ",").append(cell_text(cells)), ...);
    return *this;
  }
  [[nodiscard]] std::string line() const { return line_ + '\n'; }

 private:
  static std::string cell_text(std::string_view text) { return std::string(text); }
  static std::string cell_text(const Pose& pose) {
    const Eigen::Vector3d& p = pose.position;
    return Row().add(p.x(), p.y(), p.z(), pose.yaw).line_;
  }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  static std::string cell_text(Number number) { return to_text(number); }

  std::string line_;
};

// A name may hold anything.
std::string quoted_cell(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) text.append(c == '"' ? 2 : 1, c);
  return text + '"';
}

std::string path_rows(const RecordedStep& recorded, const planner::RecordingHead& head) {
  std::string rows;
  for (std::size_t r = 0; r < recorded.step.robots.size(); ++r) {
    const RobotStep& robot = recorded.step.robots[r];
    for (std::size_t i = 0; i < robot.planned.size(); ++i)
      rows += Row()
                  .add(recorded.step.number, quoted_cell(head.robots[r].robot.name), i,
                       i < robot.travelled ? 1 : 0, robot.planned[i])
                  .line();
  }
  return rows;
}

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

double fraction(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
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
      sums_{.seconds = std::vector<double>(planner::kPhases),
            .travelled = std::vector<double>(head.robots.size())} {
  std::string header =
      "step,robot,coverage_observable,coverage_box,robot_observable,robot_box,frontiers,unassigned,abandoned,"
      "goal_state,assigned,released,received,uncovered,goal_x_m,goal_y_m,goal_z_m,goal_yaw_rad,goal_gain,"
      "path,"
      "viewpoints,length_m,travelled_m,gain_tangent,gain_predicted,gained,still_unknown,collisions,rays";
  for (std::size_t phase = 0; phase < planner::kPhases; ++phase) {
    const auto name = planner::name_of(static_cast<planner::Phase>(phase));
    if (name == "moving") header += ",planning_s";
    header.append(",").append(name).append("_s");
  }
  write(steps_file_, kSteps, header + '\n');
  write(paths_file_, kPaths, "step,robot,viewpoint,reached,x_m,y_m,z_m,yaw_rad\n");
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
    sums_.planning_total += step.planning_seconds();
    sums_.planning_max = std::max(sums_.planning_max, step.planning_seconds());
    for (std::size_t phase = 0; phase < planner::kPhases; ++phase)
      sums_.seconds[phase] += step.seconds[phase];
  }
  std::string rows;
  for (std::size_t r = 0; r < step.robots.size(); ++r) {
    const RobotStep& robot = step.robots[r];
    sums_.travelled[r] += robot.length;
    if (!robot.blocked.empty()) ++sums_.held_back;
    Row row;
    row.add(step.number, quoted_cell(head_.robots[r].robot.name), sums_.observable, sums_.bounding,
            fraction(recorded.known[r].observable, head_.observable),
            fraction(recorded.known[r].bounding, head_.bounding), step.frontiers, step.unassigned,
            step.abandoned, step.number == 0 ? "start" : planner::name_of(robot.goal.state),
            robot.goal.assigned, robot.goal.released, robot.goal.received, robot.goal.uncovered);
    if (robot.goal.pose)
      row.add(*robot.goal.pose, robot.goal.gain);
    else
      row.add("", "", "", "", "");
    row.add(planner::name_of(robot.path), robot.planned.size(), robot.length, sums_.travelled[r],
            robot.gain_tangent, robot.gain_predicted, robot.gained, robot.still_unknown.size(),
            recorded.collisions, step.rays);
    for (std::size_t phase = 0; phase < planner::kPhases; ++phase) {
      if (planner::name_of(static_cast<planner::Phase>(phase)) == "moving") row.add(step.planning_seconds());
      row.add(step.seconds[phase]);
    }
    rows += row.line();
  }
  write(steps_file_, kSteps, rows);
  write(paths_file_, kPaths, path_rows(recorded, head_));
}

void write_run_json(const ExploreRun& run, const ExploreOptions& options, const ExploreSetup& setup,
                    const RunSums& sums, const std::string& end, double seconds) {
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
      {"options", Json::parse(json_text(options))},
  };
  // File names are bytes, JSON is Unicode.
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  write_file(run.folder / "run.json", [&](std::ostream& out) { out << text; });
}

}  // namespace frontlux::app
