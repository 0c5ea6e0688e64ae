#include "explore/run_files.hpp"

#include "explore/csv_row.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <system_error>

namespace frontlux::app {
namespace {

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
      {"contacts", [](Row row) { return csv_cell(row.recorded.contacts); }},
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
  if (step.number > 0) {
    ++sums_.steps;
    // In the last one in motion nobody looks for a goal.
    if (step.seconds[static_cast<std::size_t>(planner::Phase::kGoals)] > 0.0)
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

}  // namespace frontlux::app
