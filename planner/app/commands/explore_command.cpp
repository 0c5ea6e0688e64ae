#include "commands/explore_command.hpp"

#include "bad_input.hpp"
#include "explore/explore_options.hpp"
#include "explore/explore_run.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
#include <memory>
#include <string>
#include <utility>

namespace frontlux::app {
namespace {

struct Words {
  ExploreOptions options;
  std::optional<std::string> output, resume, max_steps;
  std::string threads = "0", report = "on";
  bool force = false;
};

int parse_threads(const std::string& text) {
  constexpr int kMost = 1024;
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || number < 0 ||
      number > kMost)
    throw BadInput("--threads: '" + text + "' is not a whole number from 0 (all cores) to " +
                   std::to_string(kMost));
  return number;
}

// Options that change what comes out; a run that goes on has its own.
void refuse_with_resume(const CLI::App& command, const Words& words) {
  if (words.output) throw BadInput("--resume: goes on in its own folder; leave -o out");
  if (words.force) throw BadInput("--resume: goes on with a run, --force replaces it; give one of them");
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    const bool allowed = name == "--resume" || name == "--threads" || name == "--max-steps" ||
                         name == "--report" || name == "--help";
    if (option->count() > 0 && !allowed)
      throw BadInput("--resume: the run has its options already; leave " + name + " out");
  }
}

void run(const CLI::App& command, Words words) {
  ExploreRun run;
  run.threads = parse_threads(words.threads);
  if (words.report != "on" && words.report != "off")
    throw BadInput("--report: '" + words.report + "' is neither on nor off");
  run.report = words.report == "on";
  run.force = words.force;
  run.max_steps = words.max_steps;
  if (words.resume) {
    refuse_with_resume(command, words);
    run.resume = true;
    run.folder = *words.resume;
  } else {
    if (words.options.source.world.empty())
      throw BadInput(
          "WORLD: give the world to explore: a built-in one (see frontlux world), a mesh or a map");
    if (!words.output) throw BadInput("-o: give a folder for the files of the run");
    run.folder = *words.output;
    if (words.max_steps) words.options.max_steps = *words.max_steps;
  }
  explore(std::move(words.options), run);
}

}  // namespace

void add_explore_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("explore", "Let robots explore a world");
  const auto words = std::make_shared<Words>();
  ExploreOptions& options = words->options;
  const auto add = [command](const char* name, auto& value, const char* what, const char* type) {
    command->add_option(name, value, what)->type_name(type);
  };
  add("WORLD", options.source.world, "A built-in world (see frontlux world), a mesh file or an OctoMap file",
      "");
  add("-o,--output", words->output, "Folder for the files of the run; made if it is not there", "DIR");
  command->add_flag("--force", words->force, "Replace the run that is in the folder");
  add("--resume", words->resume, "Go on with the run in this folder, with its own options", "DIR");
  add("--team", options.team, "Robots, with + between them: uav, ugv, 2uav+ugv; uav+ugv if not given",
      "TEAM");
  command->add_option("--robot", options.robot_files, "One more robot, described in a JSON file; repeatable")
      ->type_name("FILE.json")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--pose", options.poses, "Where a robot's sensor starts [m, rad]; repeatable")
      ->type_name("NAME=X,Y,Z,YAW")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add("--mode", options.mode, "default: what works best; paper: as printed", "NAME");
  add("--goal", options.goal,
      "How goals are chosen: render (view quality), cluster (of frontiers) or nearest; by the mode if not "
      "given",
      "NAME");
  add("--planner", options.search,
      "corridor (shortest paths), rrt, rrt-connect or rrt-star; by the mode if not given", "NAME");
  add("--renderer", options.renderer,
      "How view quality is rendered: exact (all frontiers), or rays (to drawn ones); by the mode if not "
      "given",
      "NAME");
  add("--distribute", options.distribute, "Give each frontier to one robot (on), or to all that see it (off)",
      "ON|OFF");
  add("--optimize", options.optimize,
      "Turn robots along their paths so that they see more (on), or not (off)", "ON|OFF");
  add("--caster", options.caster, "What answers visibility: fast, embree, grid or octomap", "NAME");
  add("--seed", options.seed,
      "Which of a built-in world's layouts, which random numbers, which errors of the sensors; 1 if not "
      "given",
      "N");
  add("--max-steps", words->max_steps, "End after so many steps; 1000 if not given", "N");
  add("--epsilon", options.epsilon,
      "End when three steps in a row promise fewer frontiers than this, and go first where as many are seen; "
      "10, or 1 with --goal nearest, if not given",
      "N");
  add("--lambda", options.lambda,
      "How much less a goal is worth by the metre [1/m], eq. 1; by the mode if not given", "L");
  add("--advance", options.advance,
      "Goals nearer than this [m] are worth less in proportion; 0: they are not; by the mode if not given",
      "M");
  add("--min-distance", options.min_distance, "Nearer places are no goals [m]; 0.6 if not given", "M");
  add("--samples", options.samples, "Frontiers drawn for each viewpoint; 64 if not given", "N");
  add("--resolution", options.resolution, "Edge of a voxel in metres; 0.3 if not given", "M");
  add("--noise", options.noise, "Standard deviation of a range in metres; 0 if not given", "M");
  add("--dropout", options.dropout, "Probability that a ray gives no measurement; 0 if not given", "P");
  add("--threads", words->threads, "How many to use; 0, all cores, if not given. The result is the same",
      "N");
  add("--report", words->report, "Write report.html (on), or not (off)", "ON|OFF");
  add_world_options(*command, options.source);
  command->footer(
      "Examples:\n"
      "  frontlux explore station --seed 3 -o station_run\n"
      "  frontlux explore house.ply --start 1,2,0.5 --team 2uav+ugv -o house_run\n"
      "  frontlux explore --resume station_run\n"
      "The folder then holds run.json (what was asked for and what came out), steps.csv, paths.csv, map.ot,\n"
      "map.bt, run.frontlux (the recording) and report.html. The ground of files is aligned to the map "
      "unless\n"
      "--ground off says otherwise. Ctrl-C ends a run after the step that it is in.");
  command->callback([command, words] { run(*command, *words); });
}

}  // namespace frontlux::app
