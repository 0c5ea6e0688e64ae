#include "explore/explore_setup.hpp"

#include "bad_input.hpp"
#include "text.hpp"

#include <frontlux/planner/path_optimizer.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace frontlux::app {
namespace {

using planner::Method;
using planner::Motion;
using planner::Pose;
using planner::RobotDescription;

constexpr std::size_t kMaxRobots = 32;

template <class Value, class Choices = std::initializer_list<std::pair<std::string_view, Value>>>
Value chosen(const char* option, const std::string& text, const Choices& choices) {
  std::string names;
  for (const auto& [name, value] : choices) {
    if (text == name) return value;
    names.append(names.empty() ? "" : ", ").append(name);
  }
  throw BadInput(std::string(option) + ": '" + text + "' is none of " + names);
}

bool parse_switch(const char* option, const std::string& text) {
  return chosen<bool>(option, text, {{"on", true}, {"off", false}});
}

int parse_count(const char* option, const std::string& text, int low) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || number < low)
    throw BadInput(std::string(option) + ": '" + text + "' is not a whole number of at least " +
                   std::to_string(low));
  return number;
}

// "2uav+ugv": two aerial robots and a ground robot.
std::vector<RobotDescription> parse_team(const std::string& text, Method method) {
  std::vector<RobotDescription> robots;
  if (text.empty()) return robots;
  for (std::string_view rest = text;; rest.remove_prefix(rest.find('+') + 1)) {
    const std::string_view word = rest.substr(0, rest.find('+'));
    std::size_t count = 1;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
    const std::string_view name = word.substr(static_cast<std::size_t>(end - word.data()));
    if ((error != std::errc{} && end != word.data()) || count < 1 || count > kMaxRobots ||
        (name != "uav" && name != "ugv"))
      throw BadInput("--team: '" + text +
                     "' is no team; give uav, ugv, or several with + between them, as in " +
                     "uav+ugv or 2uav+ugv");
    for (std::size_t i = 0; i < count; ++i)
      robots.push_back(name == "uav" ? planner::uav_description(method) : planner::ugv_description());
    if (rest.find('+') == std::string_view::npos) return robots;
  }
}

// Robots of the same name get numbers; those on the ground come first, since they choose first.
std::vector<RobotDescription> gather_robots(const ExploreOptions& options, Method method) {
  auto robots = parse_team(options.team, method);
  for (const std::string& file : options.robot_files) robots.push_back(planner::read_robot(file));
  if (robots.empty()) throw BadInput("--team: there is no robot; give one there or with --robot");
  if (robots.size() > kMaxRobots)
    throw BadInput("--team: " + std::to_string(robots.size()) + " robots are too many; at most " +
                   std::to_string(kMaxRobots) + " are possible");
  std::stable_partition(robots.begin(), robots.end(), [](const RobotDescription& robot) {
    return robot.robot.travel.motion == Motion::kPlane;
  });
  std::map<std::string, int> total, number;
  for (const RobotDescription& robot : robots) ++total[robot.robot.name];
  for (RobotDescription& robot : robots) {
    const std::string name = robot.robot.name;
    if (total[name] > 1) robot.robot.name += std::to_string(++number[name]);
  }
  return robots;
}

void place_by_hand(const std::string& text, double shift, const sim::GroundTruth& truth,
                   std::span<const RobotDescription> robots, std::vector<std::optional<Pose>>& starts) {
  const auto refuse = [&text](const std::string& why) { throw BadInput("--pose: '" + text + "' " + why); };
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const auto robot = std::find_if(robots.begin(), robots.end(),
                                  [&](const RobotDescription& r) { return r.robot.name == name; });
  if (equals == std::string::npos || robot == robots.end()) {
    std::string names;
    for (const RobotDescription& r : robots) names.append(names.empty() ? "" : ", ").append(r.robot.name);
    refuse("is no start; give NAME=x,y,z,yaw in metres and radians, with a name of " + names);
  }
  const std::string numbers = text.substr(equals + 1);
  const std::size_t comma = numbers.rfind(',');
  if (std::count(numbers.begin(), numbers.end(), ',') != 3)
    refuse("is no start; give four numbers, x,y,z,yaw, in metres and radians");
  Pose pose{parse_vector("--pose", numbers.substr(0, comma)).cast<double>(),
            parse_number("--pose", numbers.substr(comma + 1))};
  pose.position.z() += shift;
  try {
    if (const auto why = sim::obstacle_at(truth, robot->robot, pose)) refuse("is no place for it: " + *why);
  } catch (const std::invalid_argument& error) {
    refuse(std::string("is no place for it: ") + error.what());
  }
  starts[static_cast<std::size_t>(robot - robots.begin())] = pose;
}

// Where the robots start, and how high above which floor those in the air have to be.
void find_starts(const ExploreOptions& options, const Eigen::Vector3d& around, ExploreSetup& setup) {
  std::vector<RobotDescription>& robots = setup.head.robots;
  std::vector<planner::Robot> bodies;
  for (const RobotDescription& robot : robots) bodies.push_back(robot.robot);
  auto starts = sim::find_starts(*setup.truth, around, bodies);
  for (const std::string& pose : options.poses)
    place_by_hand(pose, setup.sourced.ground_shift, *setup.truth, robots, starts);
  std::optional<double> ground;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    if (!starts[r])
      throw BadInput(setup.sourced.world.name + ": the robot '" + robots[r].robot.name +
                     "' has no place within 15 m of the start; give another --start, or its --pose");
    if (robots[r].robot.travel.motion == Motion::kPlane)
      ground =
          std::max(ground.value_or(-1e300), starts[r]->position.z() - robots[r].robot.travel.sensor_height);
  }
  for (std::size_t r = 0; r < robots.size(); ++r) {
    if (robots[r].robot.travel.motion == Motion::kSpace)
      robots[r].robot.travel.floor = ground.value_or(sim::ground_below(*setup.truth, around));
    setup.head.starts.push_back({*starts[r], sim::start_bubble(*setup.truth, robots[r].robot, *starts[r])});
  }
}

planner::ExplorationOptions exploration_options(const ExploreOptions& options, Method method,
                                                std::span<const RobotDescription> robots) {
  planner::ExplorationOptions exploration = planner::exploration_options(method);
  exploration.seed = parse_seed(options.seed);
  if (!options.epsilon.empty())
    exploration.epsilon = parse_number("--epsilon", options.epsilon);
  else if (options.goal == "nearest")
    exploration.epsilon = 1.0;  // the nearest frontiers are few, and worth going to by this rule
  for (const RobotDescription& robot : robots) {
    planner::GoalOptions goal = planner::goal_options(robot.robot, method);
    goal.rendering.seed = exploration.seed;
    if (!options.goal.empty())
      goal.rule = chosen<planner::GoalRule>("--goal", options.goal,
                                            {{"render", planner::GoalRule::kViewQuality},
                                             {"cluster", planner::GoalRule::kClusters},
                                             {"nearest", planner::GoalRule::kNearest}});
    if (!options.renderer.empty())
      goal.rendering.renderer = chosen<ViewQualityOptions::Renderer>(
          "--renderer", options.renderer,
          {{"exact", ViewQualityOptions::Renderer::kExact}, {"rays", ViewQualityOptions::Renderer::kRays}});
    if (!options.lambda.empty()) goal.lambda = parse_number("--lambda", options.lambda);
    if (!options.advance.empty()) goal.advance = parse_number("--advance", options.advance);
    if (!options.min_distance.empty())
      goal.min_distance = parse_number("--min-distance", options.min_distance);
    if (!options.samples.empty()) goal.rendering.samples = parse_count("--samples", options.samples, 1);
    try {
      goal.check();
    } catch (const std::invalid_argument& error) {
      throw BadInput(error.what());
    }
    // Steps are quiet only when there is no better goal.
    if (method == Method::kDefault) goal.min_gain = exploration.epsilon;
    exploration.team.push_back({robot.robot, goal});
  }
  using planner::PathSearch;
  if (!options.search.empty())
    exploration.path.search = chosen<PathSearch>("--planner", options.search,
                                                 {{"rrt", PathSearch::kRrt},
                                                  {"rrt-connect", PathSearch::kRrtConnect},
                                                  {"rrt-star", PathSearch::kRrtStar},
                                                  {"corridor", PathSearch::kCorridor}});
  constexpr int kOfRrtStar = 2000;
  if (exploration.path.search == PathSearch::kRrtStar) exploration.path.iterations = kOfRrtStar;
  exploration.distribute = parse_switch("--distribute", options.distribute);
  exploration.optimize = parse_switch("--optimize", options.optimize);
  exploration.caster = chosen<CasterKind>("--caster", options.caster, kCasterNames);
  exploration.max_steps = parse_count("--max-steps", options.max_steps, 0);
  try {
    exploration.check();
  } catch (const std::invalid_argument& error) {
    throw BadInput(error.what());
  }
  return exploration;
}

sim::RangeErrors range_errors(const ExploreOptions& options) {
  sim::RangeErrors errors{.sigma = parse_number("--noise", options.noise),
                          .dropout = parse_number("--dropout", options.dropout)};
  if (errors.sigma < 0.0)
    throw BadInput("--noise: " + options.noise + " m is no standard deviation; give 0 or more");
  if (!(errors.dropout >= 0.0 && errors.dropout <= 1.0))
    throw BadInput("--dropout: " + options.dropout + " is no probability; give 0 to 1");
  return errors;
}

}  // namespace

ExploreSetup make_setup(const ExploreOptions& options,
                        const std::optional<std::vector<RobotDescription>>& robots) {
  const auto method =
      chosen<Method>("--mode", options.mode, {{"default", Method::kDefault}, {"paper", Method::kPaper}});
  ExploreSetup setup;
  setup.errors = range_errors(options);
  try {
    setup.head.robots = robots ? *robots : gather_robots(options, method);
    setup.exploration = exploration_options(options, method, setup.head.robots);

    WorldSource source = options.source;
    source.resolution = parse_resolution(options.resolution);
    const bool built_in = is_built_in_world(source.world);
    if (built_in) source.seed = options.seed;
    // The floors of worlds that others have made may lie at any height.
    if (!built_in && !source.ground) source.ground = "auto";
    if (source.ground == "off") source.ground.reset();
    std::error_code ignored;
    const bool is_there =
        std::filesystem::exists(source.world, ignored);  // what is not, is told by make_world
    if (!built_in && is_there && source.ground == "auto" && !source.start)
      throw BadInput(source.world + ": no start is known; give --start in free space, x,y,z in metres");
    setup.sourced = make_world(source);
    const Eigen::Vector3d around =
        sim::free_start(setup.sourced.world, source.resolution, setup.sourced.kind != WorldKind::kMesh);
    setup.truth = std::make_unique<const sim::GroundTruth>(setup.sourced.world, source.resolution, around);
    find_starts(options, around, setup);
    for (std::size_t r = 0; r < setup.head.robots.size(); ++r)
      setup.exploration.team[r].robot = setup.head.robots[r].robot;
    setup.head.world = setup.sourced.world.name;
    setup.head.resolution = source.resolution;
  } catch (const BadInput&) {
    throw;
  } catch (const std::invalid_argument& error) {
    throw BadInput(options.source.world + ": " + error.what());
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  }
  setup.head.bounds = setup.truth->bounds();
  setup.head.observable = setup.truth->observable_voxels();
  setup.head.bounding = setup.truth->bounding_voxels();
  setup.head.options = to_json(options);
  return setup;
}

}  // namespace frontlux::app
