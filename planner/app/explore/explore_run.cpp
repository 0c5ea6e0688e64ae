#include "explore/explore_run.hpp"

#include "bad_input.hpp"
#include "explore/explore_setup.hpp"
#include "explore/interrupt.hpp"
#include "explore/machine.hpp"
#include "explore/run_files.hpp"
#include "json.hpp"
#include "text.hpp"

#include <frontlux/file.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/report/report.hpp>
#include <frontlux/sim/simulated_robots.hpp>

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <ostream>
#include <span>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

namespace frontlux::app {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using planner::Exploration;
using planner::ExplorationStep;
using planner::RecordedStep;
using planner::Recording;

constexpr const char* kRecording = "run.frontlux";
constexpr const char* kStopped = "stopped";
constexpr std::array kFiles = {kRecording, "run.json", "steps.csv",  "paths.csv",
                               "map.ot",   "map.bt",   "report.html"};

void prepare_folder(const ExploreRun& run) {
  std::error_code error;
  const auto refuse = [&](const std::string& why) {
    throw BadInput("--output: " + run.folder.string() + " " + why);
  };
  if (fs::exists(run.folder, error) && !fs::is_directory(run.folder, error))
    refuse("is a file; name a folder");
  if (!fs::exists(run.folder, error) && !fs::create_directory(run.folder, error))
    refuse("cannot be made: " + (error ? error.message() : "no folder to make it in") +
           "; name a folder whose parent exists and may be written to");
  if (::access(run.folder.c_str(), W_OK | X_OK) != 0) refuse("cannot be written to; check its permissions");
  if (!fs::is_empty(run.folder, error)) {
    if (!run.force)
      refuse(
          "is not empty; name another folder, go on with the run in it by --resume, or replace that run by "
          "--force");
    for (const char* file : kFiles) fs::remove(run.folder / file, error);
  }
}

std::string percent(double part) { return rounded(std::round(part * 1e4) / 100) + " %"; }
std::string milli(double number) { return rounded(std::round(number * 1e3) / 1e3); }

void show(const ExplorationStep& step, const RunFiles& files, const planner::RecordingHead& head) {
  std::string line = "step " + std::to_string(step.number) + ": " + percent(files.observable()) + " known, " +
                     std::to_string(step.frontiers) + " frontiers";
  for (std::size_t r = 0; r < step.robots.size(); ++r) {
    const planner::RobotStep& robot = step.robots[r];
    line += "; " + head.robots[r].robot.name + " ";
    if (robot.goal.pose)
      line += rounded(std::round(robot.length * 10) / 10) + " m for " + std::to_string(robot.gain_predicted) +
              " of " + std::to_string(robot.goal.assigned);
    else
      line += step.number == 0 ? "looks around" : robot.length > 0.0 ? "backs off" : "waits";
  }
  if (step.number > 0) line += "; planned in " + milli(step.planning_seconds()) + " s";
  std::cout << line << std::endl;
}

// A run while it goes: the robots, the exploration that sends them, and the files that tell of it.
class Run {
 public:
  Run(ExploreSetup& setup, const ExploreRun& run)
      : setup_(setup),
        robots_(setup.sourced.world, *setup.truth, setup.head.robots, setup.errors, setup.exploration.seed,
                sim::AtContact::kStay),
        exploration_(setup.exploration,
                     planner::Mapping({.resolution = setup.head.resolution, .bounds = setup.head.bounds})),
        folder_(run.folder) {}

  /// Begins the tables anew, with the steps so far. @pre called before `begin` and `step`
  void open_files(std::span<const RecordedStep> steps) {
    files_.emplace(folder_, setup_.head);
    for (const RecordedStep& step : steps) files_->add(step);
  }

  void begin() { note(exploration_.begin(setup_.head.starts, drive())); }
  void step() { note(exploration_.step(drive())); }
  /// @throws BadInput if the world is another one now
  void repeat(const RecordedStep& recorded) {
    bool same = true;
    if (recorded.step.number == 0) {
      const ExplorationStep begun = exploration_.begin(setup_.head.starts, drive());
      for (std::size_t r = 0; r < begun.robots.size(); ++r)
        same = same && begun.robots[r].changed == recorded.step.robots[r].changed;
    } else {
      same = exploration_.repeat(recorded.step, drive());
    }
    if (!same)
      throw BadInput("--resume: in step " + std::to_string(recorded.step.number) +
                     " the robots see another world than the one recorded; has " + setup_.head.world +
                     " changed since?");
    last_ = recorded;
    begun_ = true;
    collisions_ = robots_.total().physical;
  }

  [[nodiscard]] const Exploration& exploration() const { return exploration_; }
  [[nodiscard]] const RunFiles& files() const { return *files_; }
  [[nodiscard]] const RecordedStep& last() const { return last_; }

 private:
  [[nodiscard]] planner::Drive drive() {
    return
        [this](std::size_t robot, const planner::Pose& viewpoint) { return robots_.drive(robot, viewpoint); };
  }

  void note(ExplorationStep step) {
    const std::uint64_t before = collisions_;
    collisions_ = robots_.total().physical;
    last_ = with_known_voxels(std::move(step), step_known(), *setup_.truth);
    last_.collisions = collisions_ - before;
    begun_ = true;
    files_->add(last_);
  }
  [[nodiscard]] const RecordedStep* step_known() const { return begun_ ? &last_ : nullptr; }

  ExploreSetup& setup_;
  sim::SimulatedRobots robots_;
  Exploration exploration_;
  fs::path folder_;
  std::optional<RunFiles> files_;
  RecordedStep last_;
  bool begun_ = false;
  std::uint64_t collisions_ = 0;
};

Recording read_run(const ExploreRun& run) {
  const fs::path file = run.folder / kRecording;
  std::error_code error;
  if (!fs::exists(file, error))
    throw BadInput("--resume: " + run.folder.string() + " holds no " + kRecording +
                   ", so no run to go on with; name the folder that was given to -o");
  try {
    return planner::read_recording(file);
  } catch (const std::runtime_error& failure) {
    throw BadInput(std::string("--resume: ") + failure.what());
  }
}

void check_same(const planner::RecordingHead& recorded, const planner::RecordingHead& now,
                const ExploreRun& run) {
  if (recorded.bounds == now.bounds && recorded.observable == now.observable &&
      recorded.bounding == now.bounding && recorded.resolution == now.resolution)
    return;
  throw BadInput("--resume: the world of the run in " + run.folder.string() + " is not what " + now.world +
                 " is now; start anew with the world as it is");
}

// "render", or the rules of all robots with + between them.
std::string goal_rules(std::span<const planner::TeamMember> team) {
  constexpr std::array<std::string_view, 3> kNames = {"render", "cluster", "nearest"};
  std::string names;
  for (std::size_t rule = 0; rule < kNames.size(); ++rule)
    if (std::any_of(team.begin(), team.end(), [rule](const planner::TeamMember& member) {
          return static_cast<std::size_t>(member.options.rule) == rule;
        }))
      names.append(names.empty() ? "" : "+").append(kNames[rule]);
  return names;
}

void write_run_json(const ExploreRun& run, const ExploreOptions& options, const ExploreSetup& setup,
                    const RunFiles& files, const std::string& end, double seconds) {
  std::vector<std::string> names;
  for (const planner::RobotDescription& robot : setup.head.robots) names.push_back(robot.robot.name);
  JsonObject json;
  json.add("version", FRONTLUX_VERSION).add("world", setup.head.world).add("seed", setup.exploration.seed);
  json.add("robots", std::span<const std::string>(names)).add("mode", options.mode);
  json.add("goal", goal_rules(setup.exploration.team)).add("distribute", setup.exploration.assign);
  json.add("optimize", setup.exploration.optimize).add("caster", options.caster);
  json.add("planner", planner::name_of(setup.exploration.path.search))
      .add("resolution_m", setup.head.resolution);
  json.add("max_steps", static_cast<std::uint64_t>(setup.exploration.max_steps));
  json.add("epsilon", setup.exploration.epsilon);
  json.add("threads", static_cast<std::uint64_t>(run.threads)).add("machine", machine_name());
  json.add("end", end);
  files.add_sums(json);
  json.add("wall_s", seconds).add("memory_mb", peak_memory_mb()).add_raw("options", to_json(options));
  const std::string text = json.text() + '\n';
  write_file(run.folder / "run.json", [&](std::ostream& out) { out << text; });
}

void print_summary(const ExploreRun& run, const ExploreSetup& setup, const RunFiles& files,
                   const std::string& end, double seconds) {
  std::string out = row("run", run.folder.string()) + row("world", setup.head.world) + row("end", end) +
                    row("steps", std::to_string(files.steps())) +
                    row("coverage", percent(files.observable()) + " of the observable space, " +
                                        percent(files.bounding()) + " of the world's box");
  for (std::size_t r = 0; r < setup.head.robots.size(); ++r)
    out += row(setup.head.robots[r].robot.name,
               "travelled " + rounded(std::round(files.travelled()[r] * 10) / 10) + " m");
  out += row("collisions", std::to_string(files.collisions())) +
         row("planning",
             milli(files.planning_mean()) + " s a step, at most " + milli(files.planning_max()) + " s") +
         row("time", milli(seconds) + " s");
  std::cout << out;
}

}  // namespace

void explore(ExploreOptions options, const ExploreRun& run) {
  const auto begin = Clock::now();
  std::optional<Recording> recording;
  if (run.resume) {
    recording = read_run(run);
    try {
      options = explore_options_of(recording->head.options);
    } catch (const std::runtime_error& error) {
      throw BadInput("--resume: the options in " + (run.folder / kRecording).string() +
                     " cannot be read: " + error.what());
    }
    if (run.max_steps) options.max_steps = *run.max_steps;
  }
  ExploreSetup setup = make_setup(options, recording ? std::optional(recording->head.robots) : std::nullopt);
  if (recording) check_same(recording->head, setup.head, run);
  if (!recording) prepare_folder(run);

  const InterruptNote note;
  bool stopped = false;
  tbb::task_arena arena(run.threads == 0 ? tbb::task_arena::automatic : run.threads);
  arena.execute([&] {
    const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
    try {
      Run going(setup, run);
      std::span<const RecordedStep> before;
      if (recording) before = recording->steps;
      for (const RecordedStep& step : before) going.repeat(step);  // if that is refused, all stays as it is
      // First the recording, which is locked: the files may be those of a process that is at it.
      const fs::path file = run.folder / kRecording;
      planner::RecordingWriter writer =
          recording ? planner::RecordingWriter(file, *recording) : planner::RecordingWriter(file, setup.head);
      going.open_files(before);
      const auto record = [&] {
        writer.write(going.last());
        show(going.last().step, going.files(), setup.head);
      };
      if (!recording || recording->steps.empty()) {
        going.begin();
        record();
      }
      while (!going.exploration().end() && !InterruptNote::taken()) {
        going.step();
        record();
      }
      const auto reason = going.exploration().end();
      stopped = !reason;
      const std::string end = reason ? std::string(planner::name_of(*reason)) : kStopped;
      writer.write_end(end);
      going.exploration().mapping().write(run.folder / "map.ot");
      going.exploration().mapping().write(run.folder / "map.bt");
      write_run_json(run, options, setup, going.files(), end, seconds());
      if (run.report) {
        const Recording whole = planner::read_recording(file);
        const report::ReportedRun reported{
            fs::absolute(file).lexically_normal().parent_path().filename().string(), &whole};
        report::write_report(run.folder / "report.html", {&reported, 1}, FRONTLUX_VERSION);
      }
      print_summary(run, setup, going.files(),
                    reason ? end + ": " + planner::describe(*reason, going.exploration().options()) : end,
                    seconds());
    } catch (const BadInput&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw BadInput(std::string(error.what()) +
                     "; what is recorded is kept, and frontlux explore --resume " + run.folder.string() +
                     " goes on with it");
    }
  });
  if (stopped) throw Interrupted("stopped; frontlux explore --resume " + run.folder.string() + " goes on");
}

}  // namespace frontlux::app
