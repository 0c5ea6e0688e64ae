#include "setup/explore_task.hpp"

#include "bad_input.hpp"
#include "setup/explore_setup.hpp"
#include "text.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/task_file.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

namespace frontlux::app {
namespace {

namespace fs = std::filesystem;
using io::TaskMethod, planner::GoalSearch, planner::Method;

// The options of the command that a task may hold; its own members stand for the others.
constexpr std::array<std::string_view, 30> kFurther = {
    "start",        "ground",  "scale",        "up",           "goal",          "planner",
    "renderer",     "samples", "assign",       "optimize",     "caster",        "lambda",
    "advance",      "epsilon", "min-distance", "max-steps",    "bumper",        "noise",
    "noise-growth", "dropout", "drift",        "fix-every",    "scan-delay",    "scan-loss",
    "fail",         "join",    "stray",        "sensor-model", "tours-without", "tracking-error"};

void set_method(const TaskMethod& method, ExploreOptions& options) {
  options.mode = method.goal ? Method::kDefault : Method::kPaper;
  options.goal = method.goal;
}

// The method, and the search for goals if that does not tell it.
std::pair<TaskMethod, std::optional<GoalSearch>> method_of(const ExploreOptions& options) {
  if (options.mode == Method::kPaper) return {{}, options.goal};
  if (makes_tours(options)) return {{GoalSearch::kTour}, std::nullopt};
  return {{options.goal.value_or(GoalSearch::kRender)}, std::nullopt};
}

std::string world_of(const std::string& file, const std::string& name) {
  if (is_built_in_world(name)) return name;
  const fs::path world = fs::path(file).parent_path() / name;
  std::error_code error;
  if (name.empty() || !fs::exists(world, error))
    fail(file,
         "world is " + quote(name) + ", and there is neither a file " + quote(world.string()) +
             " nor a built-in world of that name",
         "give a file relative to the task's folder, or a name that frontlux world lists");
  return world.string();
}

void read_further(const std::string& file, const io::Task& task, const Command::ReadOption& read_option) {
  for (const auto& [name, word] : task.options) {
    const std::string member = "options." + name;
    if (std::find(kFurther.begin(), kFurther.end(), name) == kFurther.end()) {
      std::string all;
      for (const std::string_view one : kFurther) all.append(all.empty() ? "" : ", ").append(one);
      fail(file, "the member " + quote(member) + " is not known", "known here: " + all);
    }
    try {
      read_option(name, word);
    } catch (const BadInput& error) {
      throw BadInput(file + ": " + member + " is wrong: " + error.what());
    }
  }
}

// Members that contradict each other. What the command line adds is not read yet.
void check_members(const std::string& file, const io::Task& task, const ExploreOptions& options) {
  const auto goal = std::find_if(task.options.begin(), task.options.end(),
                                 [](const auto& option) { return option.first == "goal"; });
  const bool has_goal = goal != task.options.end();
  // Only the paper's method leaves the goal open.
  const auto agrees = [&] {
    return task.method->goal ? goal->second == name_of(*task.method) : options.goal != GoalSearch::kTour;
  };
  if (task.method && has_goal && !agrees())
    fail(file,
         "method is '" + std::string(name_of(*task.method)) + "', but options.goal is " + quote(goal->second),
         "leave one of them out");
  if (!options.lockstep) return;
  if (options.goal == GoalSearch::kTour)
    fail(file,
         std::string("lockstep is true, but ") + (has_goal ? "options.goal" : "method") +
             " is 'tour', which is for robots in motion",
         "give another one, or leave one of them out");
  for (const std::string_view name : errors_in_motion(options))
    fail(file,
         "lockstep is true, but there is options." + std::string(name) + ", which is for robots in motion",
         "leave one of them out");
}

// The options that a task's members do not stand for, without those that are as by default.
std::vector<std::pair<std::string, std::string>> further_options(const ExploreOptions& options) {
  std::vector<std::pair<std::string, std::string>> words;
  const auto add = [&](const char* name, const auto& value) {
    if constexpr (requires { choice_name(*value); }) {
      if (value) words.emplace_back(name, choice_name(*value));
    } else {
      if (value) words.emplace_back(name, to_text(*value));
    }
  };
  const auto add_choice = [&](const char* name, auto value, auto by_default) {
    if (value != by_default) words.emplace_back(name, choice_name(value));
  };
  const auto add_number = [&](const char* name, double value, double by_default) {
    if (value != by_default) words.emplace_back(name, to_text(value));
  };
  const ExploreOptions other;
  if (const auto& ground = options.source.ground)
    words.emplace_back("ground", ground->height ? to_text(*ground->height) : ground->align ? "auto" : "off");
  add("scale", options.source.scale);
  add("up", options.source.up);
  add("goal", method_of(options).second);
  add("planner", options.search);
  add("renderer", options.renderer);
  add("samples", options.samples);
  add_choice("assign", options.assign, other.assign);
  add_choice("optimize", options.optimize, other.optimize);
  add_choice("caster", options.caster, other.caster);
  add("lambda", options.lambda);
  add("advance", options.advance);
  add("min-distance", options.min_distance);
  add("epsilon", options.epsilon);
  add("max-steps", options.max_steps);
  add_choice("sensor-model", options.sensor_model, other.sensor_model);
  add_choice("tours-without", options.tours_without, other.tours_without);
  add_choice("bumper", options.bumper, other.bumper);
  add_number("noise", options.errors.sigma, other.errors.sigma);
  add_number("noise-growth", options.errors.growth, other.errors.growth);
  add_number("dropout", options.errors.dropout, other.errors.dropout);
  add_number("stray", options.errors.stray, other.errors.stray);
  add_number("drift", options.pose_errors.drift, other.pose_errors.drift);
  add_number("tracking-error", options.pose_errors.tracking, other.pose_errors.tracking);
  add_number("fix-every", options.pose_errors.fix_every, other.pose_errors.fix_every);
  add_number("scan-delay", options.message_errors.delay, other.message_errors.delay);
  add_number("scan-loss", options.message_errors.loss, other.message_errors.loss);
  if (!options.failures.each.empty()) words.emplace_back("fail", options.failures.word);
  if (!options.joins.each.empty()) words.emplace_back("join", options.joins.word);
  return words;
}

}  // namespace

void apply_task(const std::string& file, const Command::ReadOption& read_option, ExploreOptions& options) {
  work_on(file, "give a smaller task", [&] {
    const io::Task task = io::read_task(file);
    options.task = file;
    options.name = task.name;
    options.source.world = world_of(file, task.world);
    if (task.world_seed && !is_built_in_world(options.source.world))
      fail(file, "world_seed is " + std::to_string(*task.world_seed) + ", but the world is a file",
           "leave it out");
    options.source.seed = task.world_seed;
    options.source.box = task.box;
    options.source.resolution = task.resolution.value_or(options.source.resolution);
    options.seed = task.seed.value_or(options.seed);
    options.latency = task.latency.value_or(options.latency);
    options.lockstep = task.lockstep.value_or(options.lockstep);
    if (task.method) set_method(*task.method, options);
    options.stop_coverage = task.end_coverage;
    options.stop_time = task.end_time;
    if (task.team) {
      options.team = *task.team;
      try {
        if (team_of(options.team, options.mode).empty()) throw BadInput("'' is no team; give uav+ugv");
      } catch (const BadInput& error) {
        throw BadInput(file + ": team: " + error.what());
      }
    }
    options.robots = task.robots;
    if (!options.robots.empty()) options.team.clear();
    read_further(file, task, read_option);
    check_members(file, task, options);
  });
}

std::string task_text(const ExploreOptions& options, const ExploreSetup& setup) {
  const SourcedWorld& sourced = setup.sourced;
  io::Task task;
  task.name = options.name.value_or(setup.head.world);
  task.world = options.source.world;
  if (sourced.kind == WorldKind::kBuiltIn)
    task.world_seed = sourced.seed;
  else
    task.world = options.world_path.text.empty() ? fs::absolute(task.world).lexically_normal().string()
                                                 : options.world_path.text;
  task.box = options.source.box;
  task.resolution = setup.head.resolution;
  task.seed = options.seed;
  task.latency = options.latency;
  task.lockstep = options.lockstep;
  task.method = method_of(options).first;
  task.end_coverage = options.stop_coverage;
  task.end_time = options.stop_time;
  for (std::size_t r = 0; r < setup.head.robots.size(); ++r) {
    task.robots.push_back({setup.head.robots[r], setup.given_starts[r]});
    // A shifted world would not shift a start back to the same number; there it is found again.
    if (!task.robots.back().start && sourced.ground_shift == 0.0)
      task.robots.back().start = setup.head.starts[r].pose;
  }
  task.options = further_options(options);
  const auto first = std::find_if(task.robots.begin(), task.robots.end(),
                                  [](const io::TaskRobot& robot) { return robot.start.has_value(); });
  const bool by_first = !options.source.start && first != task.robots.end() &&
                        first->start->position.cast<float>() == setup.given_start;
  if (const auto& start = setup.given_start; start && !by_first) {
    const auto number = [&](int axis) { return to_text((*start)[axis]); };
    task.options.emplace_back("start", number(0) + "," + number(1) + "," + number(2));
  }
  return io::task_text(task);
}

}  // namespace frontlux::app
