#include "explore/explore_run.hpp"

#include "bad_input.hpp"
#include "draw/film.hpp"
#include "draw/stills.hpp"
#include "explore/explore_setup.hpp"
#include "explore/run_display.hpp"
#include "explore/run_files.hpp"
#include "explore/run_json.hpp"
#include "explore/run_loop.hpp"
#include "explore/run_warnings.hpp"
#include "interrupt.hpp"

#include <frontlux/file.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/report/report.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/unseen.hpp>
#include <frontlux/stopwatch.hpp>

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <stdexcept>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace frontlux::app {
namespace {

namespace fs = std::filesystem;
using planner::RecordedStep, planner::Recording;

constexpr const char* kRecording = "run.frontlux";
constexpr const char* kStopped = "stopped";
constexpr std::array kFiles = {kRecording,   "run.json",  "steps.csv", "paths.csv", "events.csv",
                               "motion.csv", "tours.csv", "map.ot",    "map.bt",    kReport};

// Whether there is nothing to lose: at most what runs left that were killed before they began.
bool is_unused(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename() != kRecording) return false;
    try {
      static_cast<void>(planner::read_recording(entry.path()));
      return false;
    } catch (const planner::UnbegunRecording&) {
      continue;
    } catch (const std::runtime_error&) {
      return false;
    }
  }
  return !error;
}

// What `frontlux report` makes of a run, beside the films' frames.
std::vector<std::string> pictures() {
  std::vector<std::string> names(kFilms.begin(), kFilms.end());
  for (const std::string still : {kFinalMap, kCoverage})
    for (const char* ending : kStillEndings) names.push_back(still + ending);
  return names;
}

// Of runs that were killed.
void remove_unfinished_files(const fs::path& folder) {
  for (const char* file : kFiles) remove_unfinished(folder / file);
  for (const std::string& file : pictures()) remove_unfinished(folder / file);
}

[[noreturn]] void refuse_folder(const ExploreRun& run, const std::string& why) {
  throw BadInput("--output: " + run.folder.string() + " " + why);
}

[[noreturn]] void refuse_to_make(const ExploreRun& run, const std::string& why) {
  refuse_folder(run,
                "cannot be created: " + why + "; name a folder in one that exists and may be written to");
}

// Before the world is made, which may take long.
void check_folder(const ExploreRun& run, const std::string& world) {
  std::error_code error;
  if (!fs::exists(run.folder, error)) {
    fs::path folder = run.folder.has_filename() ? run.folder : run.folder.parent_path();
    do folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
    while (run.make_parents && !fs::exists(folder, error));
    if (!fs::is_directory(folder, error)) refuse_to_make(run, "its parent folder does not exist");
    if (::access(folder.c_str(), W_OK | X_OK) != 0) refuse_to_make(run, folder.string() + " is read-only");
    return;
  }
  if (!fs::is_directory(run.folder, error)) refuse_folder(run, "is a file; name a folder");
  if (::access(run.folder.c_str(), W_OK | X_OK) != 0)
    refuse_folder(run, "cannot be written to; check its permissions");
  remove_unfinished_files(run.folder);
  if (!run.force && !is_unused(run.folder))
    refuse_folder(
        run,
        "is not empty; name another folder, continue the run in it with --resume, or replace it with "
        "--force");
  for (const char* file : kFiles) {
    if (fs::is_directory(run.folder / file, error))
      refuse_folder(run, "holds a folder " + std::string(file) + "; move it away, or name another folder");
    if (fs::equivalent(run.folder / file, world, error))
      refuse_folder(run, "holds the world to explore, " + world + "; name another folder");
  }
}

void make_folder(const ExploreRun& run, const std::string& world) {
  check_folder(run, world);  // again: another process may have begun a run there since
  std::error_code error;
  if (run.make_parents) fs::create_directories(run.folder.parent_path(), error);
  if (!fs::exists(run.folder, error) && !fs::create_directory(run.folder, error))
    refuse_to_make(run, error ? error.message() : "its parent folder does not exist");
}

// The file that a link points to is none of the run's.
void remove_link(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_symlink(file, ignored) && !fs::is_other(file, ignored)) fs::remove(file, ignored);
}

// All but the recording, which the new one replaces.
void remove_old_files(const fs::path& folder) {
  std::error_code ignored;
  for (const char* file : kFiles)
    if (file != kRecording) fs::remove(folder / file, ignored);
}

// What shows a run up to a step that others follow now.
void remove_views(const fs::path& folder) {
  std::error_code ignored;
  fs::remove(folder / kReport, ignored);
  for (const std::string& file : pictures()) fs::remove(folder / file, ignored);
  remove_frames(folder / kFrames);
}

// What is left of a run that was stopped or could not go on, as the end of a message.
std::string what_is_kept(const ExploreRun& run, const planner::RecordingHead& head, std::size_t steps) {
  const fs::path file = run.folder / kRecording;
  std::error_code error;
  const std::string nothing = "; no step of the run is left there";
  try {
    const Recording left = fs::exists(file, error) ? planner::read_recording(file) : Recording{};
    if (left.steps.empty() || left.head.options != head.options) return nothing;
    const std::string kept = left.steps.size() < steps
                                 ? "; " + std::to_string(left.steps.size()) + " of its " +
                                       std::to_string(steps) + " recorded steps are kept"
                                 : "; the recorded steps are kept";
    if (::access(file.c_str(), W_OK) != 0)
      return kept + ", but " + file.string() + " is read-only: make it writable to continue the run";
    return kept + ": frontlux explore --resume " + run.folder.string() + " continues the run";
  } catch (const planner::UnbegunRecording&) {
    return nothing;
  } catch (const std::runtime_error&) {
    return "; " + file.string() + " is damaged: the run cannot be continued";
  }
}

// Whether a step comes to its end before somebody has waited for that for long.
bool completes(const std::function<void()>& step) {
  try {
    step();
    return true;
  } catch (const Interrupted&) {
    return false;
  }
}

// A step with the voxels that it made known, as it is recorded.
// @param before  the step before, or null for the first
RecordedStep with_known_voxels(planner::ExplorationStep step, const RecordedStep* before,
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

// A run in progress: the loop, and the files that record it.
class Run {
 public:
  Run(ExploreSetup& setup, const ExploreRun& run)
      : setup_(setup), loop_(make_run_loop(setup)), folder_(run.folder) {}

  /// Writes the tables up to now. @pre called before `step`
  void open_files(std::span<const RecordedStep> steps) {
    files_.emplace(folder_, setup_.head);
    for (const RecordedStep& step : steps) files_->add(step);
    files_->add(loop_->take_rows());
  }

  void step() {
    const std::uint64_t before = loop_->numbers().contacts;
    last_ = with_known_voxels(loop_->step(), last_ ? &*last_ : nullptr, *setup_.truth);
    last_->collisions = loop_->numbers().contacts - before;
    files_->add(*last_);
    files_->add(loop_->take_rows());
  }
  /// @throws BadInput if the world is another one now
  void repeat(const RecordedStep& recorded) {
    if (loop_->end() || !loop_->repeat(recorded.step))
      throw BadInput("--resume: in step " + std::to_string(recorded.step.number) +
                     " the robots see another world than the recorded one; has " + setup_.head.world +
                     " changed since?");
    last_ = recorded;
  }

  [[nodiscard]] const RunLoop& loop() const { return *loop_; }
  [[nodiscard]] const RunFiles& files() const { return *files_; }
  [[nodiscard]] const RecordedStep& last() const { return *last_; }

 private:
  ExploreSetup& setup_;
  std::unique_ptr<RunLoop> loop_;
  fs::path folder_;
  std::optional<RunFiles> files_;
  std::optional<RecordedStep> last_;
};

// A recording holds more than a robot's file may.
void check_rays(const planner::RobotDescription& robot, const fs::path& recording) {
  try {
    io::check_rays(robot);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(recording.string() + ": the robot '" + robot.robot.name + "': " + error.what());
  }
}

Recording read_run(const ExploreRun& run) {
  const fs::path file = run.folder / kRecording;
  std::error_code error;
  if (!fs::exists(run.folder, error))
    throw BadInput("--resume: there is no folder " + run.folder.string() +
                   "; name the one that was given to -o, or begin the run with -o");
  if (!fs::exists(file, error))
    throw BadInput(
        "--resume: " + run.folder.string() + " holds no " + kRecording +
        ": it is not the folder of a run, or the run had not begun; name the folder that was given "
        "to -o, or begin it anew, without --resume");
  try {
    Recording recording = planner::read_recording(file);
    for (const planner::RobotDescription& robot : recording.head.robots) check_rays(robot, file);
    // Before the recorded steps are repeated, which may take long.
    if (::access(run.folder.c_str(), W_OK | X_OK) != 0)
      throw BadInput("--resume: " + run.folder.string() + " cannot be written to; check its permissions");
    for (const char* written : kFiles)
      if (fs::exists(run.folder / written, error) && (fs::is_directory(run.folder / written, error) ||
                                                      ::access((run.folder / written).c_str(), W_OK) != 0))
        throw BadInput("--resume: " + (run.folder / written).string() +
                       " cannot be written to; check its permissions, or move it away");
    return recording;
  } catch (const BadInput&) {
    throw;
  } catch (const std::runtime_error& failure) {
    throw BadInput(std::string("--resume: ") + failure.what());
  }
}

// Where the world of a recorded run is now.
std::string find_world(const ExploreOptions& options, const ExploreRun& run) {
  const std::string& given = options.source.world;
  if (is_built_in_world(given)) {
    if (run.world)
      throw BadInput("--world: the run is in the built-in world " + given + "; leave the option out");
    return given;
  }
  if (run.world) return *run.world;
  const std::string& noted = options.world_path.text;
  std::error_code error;
  for (const std::string& world : {noted, given})
    if (fs::exists(world, error)) return world;
  std::string places = noted;
  if (noted != given) places.append(noted.empty() ? "" : " or ").append(given);
  throw BadInput("--resume: there is no file " + places +
                 ", which the run explores; say with --world FILE where it is now");
}

void check_same(const planner::RecordingHead& recorded, const planner::RecordingHead& now,
                const ExploreRun& run) {
  if (recorded.bounds == now.bounds && recorded.observable == now.observable &&
      recorded.bounding == now.bounding && recorded.resolution == now.resolution)
    return;
  throw BadInput("--resume: the world of the run in " + run.folder.string() + " is not what " + now.world +
                 " is now; start a new run");
}

// A run cannot go back behind its recorded steps.
void check_limit(const Recording& recorded, int most, const ExploreRun& run) {
  const std::uint64_t last = recorded.steps.empty() ? 0 : recorded.steps.back().step.number;
  if (last <= static_cast<std::uint64_t>(most)) return;
  const std::string number = std::to_string(last);
  throw BadInput("--resume: " + number + " steps of the run in " + run.folder.string() +
                 " are recorded already, more than the limit of " + std::to_string(most) +
                 "; give --max-steps " + number + " or more");
}

// Of a run that ended since there was nothing more to do, in a world that is not too large for that.
std::optional<sim::Unseen> unseen_of(const ExploreSetup& setup, const RunLoop& loop) {
  using planner::ExplorationEnd;
  constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 28;  // of a world, some gigabytes
  const auto ended_by = [&](ExplorationEnd end) {
    return loop.end() && loop.end()->word == planner::name_of(end);
  };
  if (setup.head.bounding > kMostVoxels) return std::nullopt;
  if (!ended_by(ExplorationEnd::kLowGain) && !ended_by(ExplorationEnd::kNothingToDo) &&
      !ended_by(ExplorationEnd::kCutOff))
    return std::nullopt;
  std::vector<planner::Robot> robots;
  std::vector<planner::Pose> starts;
  for (const planner::RobotDescription& robot : setup.head.robots) robots.push_back(robot.robot);
  for (const planner::ExplorationStart& start : setup.head.starts) starts.push_back(start.pose);
  return sim::explain_unseen(*setup.truth, loop.mapping().grid(), robots, starts);
}

}  // namespace

std::filesystem::path report_of(const ExploreRun& run) { return run.folder / kReport; }

void explore(ExploreOptions options, const ExploreRun& run) {
  const Stopwatch watch;
  std::optional<Recording> recording;
  if (!run.resume) {
    check_folder(run, options.source.world);
    note_paths(options);
  }
  if (run.resume) {
    recording = read_run(run);
    try {
      options = explore_options_of(recording->head.options);
    } catch (const std::runtime_error& error) {
      throw BadInput("--resume: the options in " + (run.folder / kRecording).string() +
                     " cannot be read: " + error.what());
    }
    if (run.max_steps)
      options.max_steps = *run.max_steps;
    else if (options.max_steps || options.lockstep)
      // The run may have gone on with a larger limit than it began with.
      options.max_steps = std::max(options.max_steps.value_or(planner::ExplorationOptions().max_steps),
                                   last_limit(run.folder).value_or(0));
  }
  ExploreOptions here = options;
  if (recording) here.source.world = find_world(options, run);
  ExploreSetup setup = make_setup(here, recording ? std::optional(recording->head.robots) : std::nullopt);
  if (recording) {
    check_same(recording->head, setup.head, run);
    check_limit(*recording, setup.exploration.max_steps, run);
  }

  const InterruptNote note;
  const planner::RecordingHead& head = recording ? recording->head : setup.head;
  std::optional<std::string> stopped;  // what to say then
  tbb::task_arena arena(run.threads == 0 ? tbb::task_arena::automatic : run.threads);
  arena.execute([&] {
    std::optional<std::size_t> recorded;  // steps, once they are this process's to lose
    try {
      Run exploring(setup, run);
      RunDisplay display(run, setup);
      std::span<const RecordedStep> before;
      if (recording) before = recording->steps;
      for (const RecordedStep& step : before) {  // before any file is touched
        if (!completes([&] { exploring.repeat(step); }) || InterruptNote::taken())
          throw Interrupted("stopped while recorded steps were repeated; the run is as it was");
        display.repeated(step.step.number + 1, before.size(), watch.seconds());
      }
      if (!recording) make_folder(run, options.source.world);
      // The recording comes first and is locked: another process may still be writing this run.
      const fs::path file = run.folder / kRecording;
      if (!recording) remove_link(file);
      planner::RecordingWriter writer =
          recording ? planner::RecordingWriter(file, *recording) : planner::RecordingWriter(file, setup.head);
      recorded = before.size();
      if (!recording) remove_old_files(run.folder);
      if (!exploring.loop().end()) remove_views(run.folder);
      remove_unfinished_files(run.folder);
      for (const char* written : kFiles)
        if (written != kRecording) remove_link(run.folder / written);
      exploring.open_files(before);
      display.begin();
      const auto record = [&] {
        writer.write(exploring.last());
        ++*recorded;
        display.step(exploring.last().step, exploring.files().sums(), watch.seconds());
      };
      const RunLoop& loop = exploring.loop();
      while (!loop.end() && !InterruptNote::taken()) {
        if (!completes([&] { exploring.step(); })) break;
        record();
      }
      const auto reason = loop.end();
      const std::string end = reason ? reason->word : kStopped;
      writer.write_end(end);
      loop.mapping().write(run.folder / "map.ot");
      loop.mapping().write(run.folder / "map.bt");
      const RunSums& sums = exploring.files().sums();
      const std::optional<sim::Unseen> unseen = unseen_of(setup, loop);
      const std::vector<std::string> warnings = run_warnings(setup, sums, loop.numbers(), reason, unseen);
      const RunResult result{
          sums,           loop.numbers(), end,
          warnings,       unseen,         sim::measure_accuracy(*setup.truth, loop.mapping().grid()),
          watch.seconds()};
      const std::string json = write_run_json(run, options, setup, result);
      if (run.report) {
        const Recording whole = planner::read_recording(file);
        const report::ReportedRun reported{
            fs::absolute(file).lexically_normal().parent_path().filename().string(), &whole,
            read_run_json(run.folder)};
        report::write_report(report_of(run), {&reported, 1}, FRONTLUX_VERSION);
      }
      display.result(result, reason, json);
      if (!reason) stopped = "stopped" + what_is_kept(run, head, *recorded);
    } catch (const BadInput&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw BadInput(error.what() + (recorded ? what_is_kept(run, head, *recorded) : ""));
    }
  });
  if (stopped) throw Interrupted(*stopped);
}

}  // namespace frontlux::app
