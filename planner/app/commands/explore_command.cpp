#include "bad_input.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "commands/sensor_model_option.hpp"
#include "explore/explore_run.hpp"
#include "setup/explore_options.hpp"
#include "setup/explore_task.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace frontlux::app {
namespace {

struct Options {
  ExploreOptions options;
  ExploreRun run;
  std::optional<std::string> output;
  std::string resume;
};

void check(const Options& given) {
  if (!given.resume.empty()) return;
  if (given.run.world)
    throw BadInput("--world: goes with --resume; name the world of a new run before the options");
  if (given.options.source.world.empty())
    throw BadInput(
        "WORLD: give the world to explore: a built-in one (see frontlux world), a mesh or a map; or a "
        "--task; see frontlux explore --help");
}

// runs/WORLD-SEED, without the folder and the ending of a world that is a file.
std::string default_folder(const ExploreOptions& options) {
  const std::filesystem::path world = options.source.world;
  const std::string name = is_built_in_world(world) ? world.string() : world.stem().string();
  return "runs/" + name + "-" + std::to_string(options.seed);
}

// Of what a task gives, an option replaces all that it stands for.
void replace_in_task(ExploreOptions& options, bool team, bool mode, bool lockstep, bool goal) {
  if (team) options.robots.clear();
  if (!goal && (mode || (lockstep && options.goal == planner::GoalSearch::kTour))) options.goal.reset();
}

void run(Options given) {
  check(given);
  given.run.resume = !given.resume.empty();
  given.run.make_parents = !given.run.resume && !given.output;
  given.run.folder = given.run.resume ? given.resume
                     : !given.output  ? default_folder(given.options)
                                      : *given.output;
  if (given.run.max_steps) given.options.max_steps = given.run.max_steps;
  explore(std::move(given.options), given.run);
}

// @return --mode and --goal
std::pair<Option, Option> add_method_options(Command& command, ExploreOptions& options) {
  command.group("Method");
  Option mode = command.add("--mode", options.mode, "What works best, or as printed in the paper");
  Option goal =
      command.add("--goal", options.goal,
                  "Tours for the whole team, or one goal after the other: by view quality, clusters of\n"
                  "frontiers, or distance [tour; --lockstep: render; --mode paper: its own]");
  command.group("Method", Command::Shown::kInHelpAll);
  command.add("--planner", options.search, "Path search; corridor: shortest paths [by mode]");
  command.add("--renderer", options.renderer,
              "View quality of all frontiers, or by rays to drawn ones [by mode]");
  command.add("--samples", options.samples, "N", "Frontiers drawn for each viewpoint with rays [by mode]",
              kSampleCounts);
  command.add("--assign", options.assign, "Assign each frontier to one robot, or to all that see it");
  command.add("--optimize", options.optimize, "Turn viewpoints so that they see more frontiers");
  command.add("--tours-without", options.tours_without,
              "A part of the search for tours that is left out, to see what it adds; without tours a robot\n"
              "goes to the stop that it reaches soonest");
  command.add("--caster", options.caster, "Ray caster that answers visibility");
  add_sensor_model_option(command, options.sensor_model);
  command.add("--lambda", options.lambda, "PER_METRE",
              "Decay of a goal's value with its distance, eq. 1 [0.1386]", kFromZero);
  command.add("--advance", options.advance, "METRES",
              "Goals nearer than this lose value in proportion; 0: they do not [by mode]", kFromZero);
  command.add("--min-distance", options.min_distance, "METRES", "Least distance of a goal [0.6]", kFromZero);
  return {mode, goal};
}

}  // namespace

void add_explore_command(CLI::App& app) {
  Command command(app, "explore", "Let simulated robots explore a world");
  const auto given = std::make_shared<Options>();
  ExploreOptions& options = given->options;
  command.group("Run");
  command.add_action("--task", "FILE.json",
                     "What to explore, how and with whom (docs/tasks.md); other options win over it",
                     [&options, read_option = command.read_option()](std::string_view file) {
                       apply_task(std::string(file), read_option, options);
                     });
  command.add("WORLD", options.source.world, "", "Built-in world (see frontlux world), mesh or OctoMap file");
  command.add("-o,--output", given->output, "DIR",
              "Folder for the files of the run; created if missing, in one that exists [runs/WORLD-SEED]");
  command.add_flag("--force", given->run.force, "Replace the run in the folder");
  Option resume =
      command.add("--resume", given->resume, "DIR", "Continue the run in this folder, with its options");
  command.add("--threads", given->run.threads, "N",
              "Number of threads, which does not change the result; 0: all cores", Range<int>{0, 1024});
  command.add("--report", given->run.report, "Write report.html");
  command.add("--seed", options.seed, "N", "Random seed (built-in layout, draws, noise)", kSeeds);
  command.group("Run", Command::Shown::kInHelpAll);
  command.add("--world-seed", options.source.seed, "N", "Random seed of a built-in world's layout [--seed]",
              kSeeds);
  command.add("--world", given->run.world, "FILE", "With --resume: where the world's file is now");
  command.group("Output");
  command.add_flag("-q,--quiet", given->run.quiet, "Print nothing but warnings and errors");
  command.add_flag("--json", given->run.json,
                   "Print the result as one JSON object: run.json, folder, report");
  command.group("Clock");
  Option lockstep =
      command.add_flag("--lockstep", options.lockstep,
                       "Alg. 1 as printed: all robots plan, move, stop at each viewpoint, and wait for all");
  command.add("--latency", options.latency, "SECONDS", "Time from a planning to the begin of its trajectory",
              kLatencies);
  command.group("Stopping");
  command.add("--stop-coverage", options.stop_coverage, "PART",
              "Stop when this part of the observable space is mapped, 0 to 1", kProbability);
  command.add("--stop-time", options.stop_time, "SECONDS", "Stop after this time on the clock", kFromZero);
  command.add("--max-steps", given->run.max_steps, "N",
              "Stop after this many steps [1000],\nin motion plannings [no limit]", kStepLimits);
  command.group("Stopping", Command::Shown::kInHelpAll);
  command.add("--epsilon", options.epsilon, "FRONTIERS",
              "Stop when the expected gain stays below this for 3 steps,\n"
              "in motion for 3 goals of each robot;\n"
              "goals of at least this gain come first [10; --goal nearest,\n"
              "--mode paper: 1; tours: at least 0.3 m2, at most 0.9 m2]",
              kFromZero);
  command.group("Robots");
  Option team = command.add("--team", options.team, "TEAM", "Robots joined by +: uav, ugv, 2uav+ugv");
  command.add("--robot", options.robot_files, "FILE.json", "Add a robot described in this file; repeatable");
  command.add("--pose", options.poses, "NAME=X,Y,Z,YAW", "Start pose of a robot's sensor; repeatable");
  command.group("Robots", Command::Shown::kInHelpAll);
  command.add("--bumper", options.bumper,
              "A robot that would touch a surface stops; off: contacts are counted");
  command.add("--noise", options.errors.sigma, "METRES", "Standard deviation of a range", kRangeNoise);
  command.add("--noise-growth", options.errors.growth, "K",
              "Further standard deviation of a range: this times its square [1/m]", kNoiseGrowth);
  command.add("--dropout", options.errors.dropout, "P", "Probability that a ray gives no measurement",
              kProbability);
  command.add("--stray", options.errors.stray, "P",
              "Probability that a ray returns from nowhere, as from dust, before any surface; "
              "explorations end early above some 0.0003",
              kProbability);
  command.add("--drift", options.pose_errors.drift, "PART",
              "Error of where a robot believes to be, as a part of its path since it last knew, 0 to 1",
              kProbability);
  command.add("--fix-every", options.pose_errors.fix_every, "SECONDS",
              "After how long it learns where it is; 0: never", kFromZero);
  command.add("--tracking-error", options.pose_errors.tracking, "METRES",
              "How far a robot at its full speed is beside its trajectory, at most; it knows",
              kTrackingErrors);
  command.add("--scan-delay", options.message_errors.delay, "SECONDS",
              "Time that a scan takes to the map that the robots share", kScanDelays);
  command.add("--scan-loss", options.message_errors.loss, "P", "Probability that a scan never gets there",
              kProbability);
  command.add("--fail", options.failures, "NAME=SECONDS",
              "A robot fails after this time, and stays where it is; more with commas between");
  command.add("--join", options.joins, "NAME=SECONDS",
              "A robot takes part from this time on only, and stays at its start until then; or again, "
              "after --fail");
  const auto method = add_method_options(command, options);
  add_world_options(command, options.source, "auto; built-in worlds: off");
  command.allow_only(resume, {"--world", "--threads", "--max-steps", "--report", "--quiet", "--json"});
  command.examples(R"(Examples:
  frontlux explore station --seed 3
  frontlux explore house.ply --start 1,2,0.5 --team 2uav+ugv -o house_run
  frontlux explore --task data/tasks/maze.json -o maze_run
  frontlux explore --resume runs/station-3
Files of a run: run.json (options and results), steps.csv, paths.csv, events.csv, motion.csv and tours.csv (of
robots in motion), map.ot, map.bt, run.frontlux (the recording) and report.html. Ctrl-C or SIGTERM ends a run
after the current step. --help-all has more options.)");
  command.run([given, team, lockstep, method] {
    const auto& [mode, goal] = method;
    replace_in_task(given->options, team.given(), mode.given(), lockstep.given(), goal.given());
    run(*given);
  });
}

}  // namespace frontlux::app
