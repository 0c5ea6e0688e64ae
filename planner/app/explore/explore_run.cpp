#include "explore/explore_run.hpp"

#include "bad_input.hpp"
#include "explore/resumed_run.hpp"
#include "explore/run_display.hpp"
#include "explore/run_files.hpp"
#include "explore/run_folder.hpp"
#include "explore/run_json.hpp"
#include "explore/run_loop.hpp"
#include "explore/run_warnings.hpp"
#include "interrupt.hpp"
#include "setup/explore_setup.hpp"
#include "terminal.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/report/report.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/unseen.hpp>
#include <frontlux/stopwatch.hpp>

#include <tbb/task_arena.h>

#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace frontlux::app {
namespace {

namespace fs = std::filesystem;
using planner::RecordedStep, planner::Recording;

// Files that a run reads and must not overwrite.
std::vector<std::string> inputs_of(const ExploreOptions& options) {
  std::vector<std::string> files{options.source.world, options.task};
  files.insert(files.end(), options.robot_files.begin(), options.robot_files.end());
  return files;
}

constexpr const char* kStopped = "stopped";

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

// A run in progress: the loop, the files that record it, and what is shown of it.
class Run {
 public:
  /// @param recording  of a resumed run, else null
  /// @param watch      since the command began
  Run(const ExploreRun& how, const ExploreOptions& options, ExploreSetup& setup, const Recording* recording,
      const Stopwatch& watch)
      : how_(how),
        options_(options),
        setup_(setup),
        recording_(recording),
        watch_(watch),
        loop_(make_run_loop(setup)),
        display_(how, setup) {}

  /// The recorded steps of a resumed run, before any file is touched.
  /// @throws BadInput if the world is another one now
  void repeat_recorded_steps() {
    for (const RecordedStep& step : recorded_steps()) {
      if (!completes([&] { repeat(step); }) || InterruptNote::taken())
        throw Interrupted("stopped while recorded steps were repeated; the run is as it was");
      display_.repeated(step.step.number + 1, recorded_steps().size(), watch_.seconds());
    }
  }

  /// Takes the folder for this run, and writes the tables up to now.
  void open_files() {
    // The recording comes first and is locked: another process may still be writing this run.
    if (recording_ != nullptr) {
      writer_.emplace(file(), *recording_);
    } else {
      make_folder(how_, inputs_of(options_));
      remove_link(file());
      writer_.emplace(file(), setup_.head);
      remove_old_files(how_.folder);
    }
    recorded_ = recorded_steps().size();
    if (!loop_->end()) remove_views(how_.folder);
    remove_unfinished_files(how_.folder);
    for (const std::string_view written : kRunFiles)
      if (written != kRecording) remove_link(how_.folder / written);
    files_.emplace(how_.folder, setup_.head);
    for (const RecordedStep& step : recorded_steps()) files_->add(step);
    files_->add(loop_->take_rows());
    display_.begin();
  }

  /// Until the run ends, or somebody stops it.
  void explore() {
    while (!loop_->end() && !InterruptNote::taken()) {
      if (!completes([&] { step(); })) break;
      writer_->write(*last_);
      ++*recorded_;
      display_.step(last_->step, files_->sums(), watch_.seconds());
    }
  }

  /// The result, the maps and the report.
  void write_result() {
    const auto reason = loop_->end();
    const std::string end = reason ? reason->word : kStopped;
    writer_->write_end(end);
    display_.ended(watch_.seconds());
    loop_->mapping().write(how_.folder / "map.ot");
    loop_->mapping().write(how_.folder / "map.bt");
    const RunSums& sums = files_->sums();
    const std::optional<sim::Unseen> unseen = unseen_of(setup_, *loop_);
    const std::vector<std::string> warnings = run_warnings(setup_, sums, loop_->numbers(), reason, unseen);
    const RunResult result{sums,
                           loop_->numbers(),
                           end,
                           warnings,
                           unseen,
                           sim::measure_accuracy(*setup_.truth, loop_->mapping().grid()),
                           watch_.seconds()};
    const std::string json = write_run_json(how_, options_, setup_, result);
    if (how_.report && last_) {
      const Recording whole = planner::read_recording(file());
      const report::ReportedRun reported{
          fs::absolute(file()).lexically_normal().parent_path().filename().string(), &whole,
          read_run_json(how_.folder)};
      report::write_report(report_of(how_), {&reported, 1}, FRONTLUX_VERSION);
    }
    display_.result(result, reason, json);
  }

  [[nodiscard]] bool has_ended() const { return loop_->end().has_value(); }
  /// As the end of a message; nothing before the run has taken its folder.
  [[nodiscard]] std::string kept() const {
    const planner::RecordingHead& head = recording_ != nullptr ? recording_->head : setup_.head;
    return recorded_ ? what_is_kept(how_, head, *recorded_) : "";
  }

 private:
  [[nodiscard]] fs::path file() const { return how_.folder / kRecording; }
  [[nodiscard]] std::span<const RecordedStep> recorded_steps() const {
    return recording_ != nullptr ? recording_->steps : std::span<const RecordedStep>();
  }

  void step() {
    const std::uint64_t before = loop_->numbers().contacts;
    last_ = with_known_voxels(loop_->step(), last_ ? &*last_ : nullptr, *setup_.truth);
    last_->contacts = loop_->numbers().contacts - before;
    files_->add(*last_);
    files_->add(loop_->take_rows());
  }

  void repeat(const RecordedStep& recorded) {
    if (loop_->end() || !loop_->repeat(recorded.step))
      throw BadInput("--resume: in step " + std::to_string(recorded.step.number) +
                     " the robots see another world than the recorded one; has " + setup_.head.world +
                     " changed since, or frontlux?");
    last_ = recorded;
  }

  const ExploreRun& how_;
  const ExploreOptions& options_;
  ExploreSetup& setup_;
  const Recording* recording_;
  const Stopwatch& watch_;
  std::unique_ptr<RunLoop> loop_;
  RunDisplay display_;
  std::optional<planner::RecordingWriter> writer_;
  std::optional<RunFiles> files_;
  std::optional<RecordedStep> last_;
  std::optional<std::size_t> recorded_;  // steps, once they are this process's to lose
};

}  // namespace

std::filesystem::path report_of(const ExploreRun& run) { return run.folder / kReport; }

void explore(ExploreOptions options, const ExploreRun& run) {
  const Stopwatch watch;
  std::optional<Recording> recording;
  if (run.resume) {
    recording = read_run(run);
    options = options_of(*recording, run);
  } else {
    check_folder(run, inputs_of(options));
    note_paths(options);
  }
  ExploreOptions here = options;
  if (recording) here.source.world = find_world(options, run);
  std::optional<WorkingLine> working;
  if (!run.quiet) working.emplace("preparing " + here.source.world);
  ExploreSetup setup = make_setup(here, recording ? std::optional(recording->head.robots) : std::nullopt);
  working.reset();
  if (recording) {
    check_continues(*recording, setup.head, setup.exploration.max_steps, run);
    setup.head.world = recording->head.world;  // its file may have another name by now
  }

  InterruptNote note;
  std::optional<std::string> stopped;  // what to say then
  tbb::task_arena arena(run.threads == 0 ? tbb::task_arena::automatic : run.threads);
  arena.execute([&] {
    std::optional<Run> exploring;
    try {
      exploring.emplace(run, options, setup, recording ? &*recording : nullptr, watch);
      exploring->repeat_recorded_steps();
      exploring->open_files();
      note.advise("; what was recorded is kept, other files may be missing: " + how_to_resume(run));
      exploring->explore();
      exploring->write_result();
      if (!exploring->has_ended()) stopped = "stopped" + exploring->kept();
    } catch (const BadInput&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw BadInput(error.what() + (exploring ? exploring->kept() : ""));
    }
  });
  if (stopped) throw Interrupted(*stopped);
}

}  // namespace frontlux::app
