#include "explore/resumed_run.hpp"

#include "bad_input.hpp"
#include "explore/run_folder.hpp"
#include "explore/run_json.hpp"

#include <frontlux/io/task_file.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace frontlux::app {
namespace {

namespace fs = std::filesystem;
using planner::Recording;

// A recording may hold robots that no file may, and that ask for too much.
void check_robots(const planner::RecordingHead& head, const fs::path& recording) {
  std::vector<io::TaskRobot> robots;
  std::set<std::string> names;
  for (const planner::RobotDescription& robot : head.robots) {
    robots.push_back({robot, std::nullopt});
    names.insert(robot.robot.name);
  }
  try {
    static_cast<void>(io::robots_of(io::robots_text(robots)));
    if (names.size() < robots.size())
      throw std::runtime_error("two of its robots have the same name; begin the run anew");
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(recording.string() + ": " + error.what());
  }
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

}  // namespace

Recording read_run(const ExploreRun& run) {
  const fs::path file = run.folder / kRecording;
  std::error_code error;
  if (!fs::exists(run.folder, error))
    throw BadInput("--resume: there is no folder " + run.folder.string() +
                   "; name the one that was given to -o, or begin the run with -o");
  if (fs::is_regular_file(run.folder, error))
    throw BadInput("--resume: " + run.folder.string() + " is a file; name its folder, " +
                   (run.folder.has_parent_path() ? run.folder.parent_path() : fs::path(".")).string());
  if (!fs::exists(file, error))
    throw BadInput(
        "--resume: " + run.folder.string() + " holds no " + std::string(kRecording) +
        ": it is not the folder of a run, or the run had not begun; name the folder that was given "
        "to -o, or begin it anew, without --resume");
  try {
    Recording recording = planner::read_recording(file);
    check_robots(recording.head, file);
    // Before the recorded steps are repeated, which may take long.
    if (::access(run.folder.c_str(), W_OK | X_OK) != 0)
      throw BadInput("--resume: " + run.folder.string() + " cannot be written to; check its permissions");
    for (const std::string_view written : kRunFiles)
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

ExploreOptions options_of(const Recording& recorded, const ExploreRun& run) {
  ExploreOptions options;
  try {
    options = explore_options_of(recorded.head.options);
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
  return options;
}

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

void check_continues(const Recording& recorded, const planner::RecordingHead& now, int most_steps,
                     const ExploreRun& run) {
  check_same(recorded.head, now, run);
  check_limit(recorded, most_steps, run);
}

}  // namespace frontlux::app
