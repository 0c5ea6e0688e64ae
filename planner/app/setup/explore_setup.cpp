#include "setup/explore_setup.hpp"

#include "bad_input.hpp"
#include "text.hpp"

#include <frontlux/sim/start_pose.hpp>

#include <algorithm>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace frontlux::app {
namespace {

using planner::GoalSearch, planner::Method, planner::Motion, planner::Pose, planner::RobotDescription;

// Where the robots are to start, and who says so, in messages. A task's robots come first among those that
// move as they do, as in `gather_robots`.
struct GivenStarts {
  std::vector<std::optional<Pose>> poses;
  std::vector<std::string> givers;
};
// Where else options may come from, for the end of a message.
std::string or_in_task(const ExploreOptions& options) {
  return options.task.empty() ? "" : " (some options are those of the task " + options.task + ")";
}

void check_errors_in_motion(const ExploreOptions& options) {
  const std::vector<std::string_view> errors = errors_in_motion(options);
  if (options.lockstep && !errors.empty())
    throw BadInput("--" + std::string(errors.front()) +
                   " is not for --lockstep, in which robots stop and wait; leave one of the options out" +
                   or_in_task(options));
  if (options.pose_errors.fix_every > 0.0 && options.pose_errors.drift == 0.0)
    throw BadInput(
        "--fix-every is for --drift, without which poses have no error; give both, or leave it out" +
        or_in_task(options));
  for (const auto& [part, name] :
       {std::pair(options.errors.dropout, "--dropout"), {options.message_errors.loss, "--scan-loss"}})
    if (part == 1.0 && !options.stop_time && !options.max_steps && !options.lockstep)
      throw BadInput(
          std::string(name) +
          ": of 1 nothing is ever measured, so that the run would go on for long or for ever; give "
          "less, or --stop-time or --max-steps as well" +
          or_in_task(options));
}

GivenStarts given_starts(const ExploreOptions& options, std::span<const RobotDescription> robots) {
  GivenStarts given{std::vector<std::optional<Pose>>(robots.size()), std::vector<std::string>(robots.size())};
  const auto drives = [](const RobotDescription& robot) { return robot.robot.travel.drives(); };
  const auto first_flying = static_cast<std::size_t>(std::count_if(robots.begin(), robots.end(), drives));
  std::size_t driving = 0, flying = first_flying;
  for (const io::TaskRobot& robot : options.robots) {
    const bool on_ground = drives(robot.description);
    const std::size_t r = on_ground ? driving++ : flying++;
    if (r >= (on_ground ? first_flying : robots.size()))
      throw BadInput("--resume: the recorded options name other robots than the run has; begin it anew");
    given.poses[r] = robot.start;
    given.givers[r] = options.task + ": the start of the robot '" + robots[r].robot.name + "'";
  }
  std::vector<bool> placed(robots.size());
  for (const StartPose& start : options.poses) {
    const std::string giver = "--pose: " + quote(start.word);
    const std::size_t r = robot_named(start.robot, giver, robots);
    if (placed[r]) throw BadInput(giver + " places " + start.robot + ", which another --pose does already");
    placed[r] = true;
    given.poses[r] = start.pose;
    given.givers[r] = giver;
  }
  return given;
}

Pose place_by_hand(Pose pose, const std::string& giver, double shift, const sim::GroundTruth& truth,
                   const RobotDescription& robot) {
  pose.position.z() += shift;
  std::optional<std::string> obstacle;
  try {
    obstacle = sim::obstacle_at(truth, robot.robot, pose);
  } catch (const std::invalid_argument& error) {
    obstacle = error.what();
  }
  if (obstacle) throw BadInput(giver + " is not a free place: " + *obstacle + "; give another one");
  return pose;
}

// Robots that are put by hand may be put into each other. Their bodies count by the boxes around them, as
// when they keep apart.
void check_apart(const GivenStarts& given, std::span<const RobotDescription> robots,
                 std::span<const std::optional<Pose>> starts) {
  const auto name = [&](std::size_t r) { return "'" + robots[r].robot.name + "'"; };
  const auto body = [&](std::size_t r) {
    return planner::body_of(robots[r].robot.travel).translated(starts[r]->position);
  };
  for (std::size_t a = 0; a < robots.size(); ++a)
    for (std::size_t b = a + 1; b < robots.size(); ++b) {
      if (!starts[a] || !starts[b] || (!given.poses[a] && !given.poses[b])) continue;
      if ((body(a).intersection(body(b)).sizes().array() <= sim::GroundTruth::kMargin).any()) continue;
      throw BadInput((given.poses[b] ? given.givers[b] : given.givers[a]) + ": the bodies of the robots " +
                     name(a) + " and " + name(b) + " overlap, with their sensors " +
                     fixed((starts[a]->position - starts[b]->position).norm(), 2) +
                     " m apart; start them farther from each other");
    }
}

// [m] Of the lowest layer in which there is free space.
double lowest_floor(const sim::GroundTruth& truth) {
  KeyBox layer = truth.bounds();
  const auto is_solid = [&](const VoxelKey& key) { return truth.at(key) != sim::Truth::kFree; };
  for (; layer.min.z < truth.bounds().max.z; ++layer.min.z) {
    layer.max.z = layer.min.z;
    if (!all_of(layer, is_solid)) break;
  }
  return sim::lower_face(truth.lattice(), layer.min.z);
}

// Cells that are nodes begin where their nodes do.
void check_height(const RobotDescription& robot, const Pose& start, const std::string& giver,
                  const Lattice& lattice) {
  constexpr double kRounding = 1e-6;  // [m]
  const planner::TravelOptions& travel = robot.robot.travel;
  const auto key = lattice.key(start.position.z());
  if (travel.drives() || travel.node_edge > 0.0 || !key) return;
  const double height = lattice.center(*key) - travel.floor;
  if (height >= travel.min_height - kRounding) return;
  throw BadInput((giver.empty() ? "the start of the robot '" + robot.robot.name + "'" : giver) + " is " +
                 fixed(height, 2) + " m above the floor at z = " + fixed(travel.floor, 2) +
                 " m, but the robot keeps " + fixed(travel.min_height, 2) +
                 " m: give it a higher start with --pose, or lower its min_height_m");
}

// Where the robots do start, and how high above which floor those in the air have to be: in lock-step above
// that which they start on, in motion above the world's lowest one, so that they may go down stairs.
void find_starts(const GivenStarts& given, const Eigen::Vector3d& around, ExploreSetup& setup) {
  std::vector<RobotDescription>& robots = setup.head.robots;
  std::vector<planner::Robot> bodies;
  for (const RobotDescription& robot : robots) bodies.push_back(robot.robot);
  auto starts = sim::find_starts(*setup.truth, around, bodies);
  for (std::size_t r = 0; r < robots.size(); ++r)
    if (given.poses[r])
      starts[r] = place_by_hand(*given.poses[r], given.givers[r], setup.sourced.ground_shift, *setup.truth,
                                robots[r]);
  check_apart(given, robots, starts);
  std::optional<double> ground;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    if (!starts[r])
      throw BadInput(setup.sourced.world.name + ": the robot '" + robots[r].robot.name +
                     "' does not fit within 15 m of the start at " +
                     to_text(Eigen::Vector3f(around.cast<float>())) +
                     " m; give another --start, or its --pose, or check its body and its heights");
    if (robots[r].robot.travel.drives())
      ground =
          std::max(ground.value_or(-1e300), starts[r]->position.z() - robots[r].robot.travel.sensor_height);
  }
  for (std::size_t r = 0; r < robots.size(); ++r) {
    if (robots[r].robot.travel.motion == Motion::kSpace)
      robots[r].robot.travel.floor = setup.lockstep ? ground.value_or(sim::ground_below(*setup.truth, around))
                                                    : lowest_floor(*setup.truth);
    check_height(robots[r], *starts[r], given.givers[r], setup.truth->lattice());
    setup.head.starts.push_back({*starts[r], sim::start_bubble(*setup.truth, robots[r].robot, *starts[r])});
  }
}

// Says what of a robot does not go with the voxels.
void check_travel(const RobotDescription& robot, const sim::GroundTruth& truth) {
  try {
    planner::TravelCorridor(robot.robot.travel, truth.lattice(), truth.bounds());
  } catch (const std::invalid_argument& error) {
    throw BadInput("the robot '" + robot.robot.name + "': " + error.what() +
                   "; change the robot's file, or --resolution");
  }
}

planner::GoalOptions goal_options(const ExploreOptions& options, const planner::Robot& robot,
                                  double epsilon) {
  planner::GoalOptions goal = options.lockstep ? planner::goal_options(robot, options.mode, epsilon)
                                               : planner::motion_goal_options(robot, options.mode, epsilon);
  if (options.goal) goal.rule = planner::rule_of(*options.goal).value_or(goal.rule);
  goal.lambda = options.lambda.value_or(goal.lambda);
  goal.advance = options.advance.value_or(goal.advance);
  goal.min_distance = options.min_distance.value_or(goal.min_distance);
  goal.rendering.renderer = options.renderer.value_or(goal.rendering.renderer);
  goal.rendering.samples = options.samples.value_or(goal.rendering.samples);
  goal.rendering.seed = options.seed;
  goal.check();
  return goal;
}

// And what to give instead.
std::string how_goals_are_chosen(const ExploreOptions& options) {
  if (makes_tours(options))
    return "tours, which choose their stops otherwise; give --goal render, cluster or nearest";
  return options.goal == GoalSearch::kNearest
             ? "--goal nearest, which goes by distance alone; give --goal render or cluster"
             : "--renderer exact, which counts all frontiers; give --renderer rays";
}

planner::ExplorationOptions exploration_options(const ExploreOptions& options,
                                                std::span<const RobotDescription> robots) {
  if (options.goal == GoalSearch::kTour && (options.lockstep || options.mode == Method::kPaper))
    throw BadInput(std::string("--goal tour is not for ") +
                   (options.lockstep ? "--lockstep" : "--mode paper") +
                   "; give another goal, or leave it out" + or_in_task(options));
  if (const auto ignored = ignored_by_goals(options); !ignored.empty())
    throw BadInput("--" + std::string(ignored.front()) + " is not for " + how_goals_are_chosen(options) +
                   " with it, or leave it out" + or_in_task(options));
  if (options.tours_without != planner::TourPart::kNone && !makes_tours(options))
    throw BadInput("--tours-without is for robots on tours; leave it out, or give --goal tour in motion" +
                   or_in_task(options));
  planner::ExplorationOptions exploration = options.lockstep ? planner::exploration_options(options.mode)
                                            : makes_tours(options)
                                                ? planner::tour_options(options.source.resolution)
                                                : planner::motion_options(options.mode);
  exploration.seed = options.seed;
  // With nearest goals each gain is small, so that small gains do not end the exploration.
  if (options.goal == GoalSearch::kNearest) exploration.epsilon = 1.0;
  exploration.epsilon = options.epsilon.value_or(exploration.epsilon);
  for (const RobotDescription& robot : robots)
    exploration.team.push_back({robot.robot, goal_options(options, robot.robot, exploration.epsilon)});
  exploration.path = planner::path_options(options.search.value_or(exploration.path.search));
  exploration.tours_without = options.tours_without;
  exploration.assign = options.assign;
  exploration.optimize = options.optimize;
  exploration.caster = options.caster;
  exploration.max_steps = options.max_steps.value_or(exploration.max_steps);
  exploration.latency = options.latency;
  exploration.check();
  return exploration;
}

// The source with what the options leave open.
WorldSource source_of(const ExploreOptions& options, const GivenStarts& given) {
  WorldSource source = options.source;
  const auto first =
      std::find_if(given.poses.begin(), given.poses.end(), [](const auto& pose) { return pose.has_value(); });
  if (!source.start && first != given.poses.end() && !options.robots.empty()) {
    source.start_otherwise = (*first)->position.cast<float>();
    source.start_giver = given.givers[static_cast<std::size_t>(first - given.poses.begin())];
  }
  if (is_built_in_world(source.world)) {
    source.seed = source.seed.value_or(options.seed);
    return source;
  }
  if (std::filesystem::path(source.world).extension() == ".json")
    throw BadInput(source.world + ": is no world; if it is a task, give it as --task " + source.world);
  if (source.seed)
    throw BadInput("--world-seed: " + source.world + " is not a built-in world; leave the option out");
  // The floors of worlds that others have made may lie at any height. Who gives a box knows the floor.
  if (!source.ground) source.ground = GroundAlignment{!source.box};
  if (source.start_otherwise) return source;
  std::error_code ignored;  // of a file that is missing, or a directory, make_world says so
  const auto file = std::filesystem::status(source.world, ignored);
  if (std::filesystem::exists(file) && !std::filesystem::is_directory(file) && source.ground->align &&
      !source.ground->height && !source.start)
    throw BadInput(source.world + ": no start is known; give --start in free space, x,y,z in metres");
  return source;
}

// The start that was put into the world, before its shift; nothing if it has its own.
std::optional<Eigen::Vector3f> start_in(const SourcedWorld& sourced, const WorldSource& source) {
  if (source.start || !source.start_otherwise) return source.start;
  const bool own =
      sourced.kind == WorldKind::kBuiltIn && sourced.world.start != source.start_otherwise->cast<double>();
  return own ? std::nullopt : source.start_otherwise;
}

}  // namespace

ExploreSetup make_setup(const ExploreOptions& options,
                        const std::optional<std::vector<RobotDescription>>& robots) {
  ExploreSetup setup;
  setup.errors = options.errors;
  setup.pose_errors = options.pose_errors;
  setup.message_errors = options.message_errors;
  setup.lockstep = options.lockstep;
  setup.at_contact = options.bumper ? sim::AtContact::kStay : sim::AtContact::kGoOn;
  setup.sensor_model = options.sensor_model;
  setup.stop_coverage = options.stop_coverage;
  setup.stop_time = options.stop_time;
  work_on(options.task.empty() ? options.source.world : options.task, "give a coarser --resolution", [&] {
    setup.head.robots = robots ? *robots : gather_robots(options);
    setup.exploration = exploration_options(options, setup.head.robots);
    check_errors_in_motion(options);
    setup.attendance = attendance_of(options, setup.head.robots);
    const GivenStarts given = given_starts(options, setup.head.robots);
    const WorldSource source = source_of(options, given);
    setup.given_starts = given.poses;
    setup.sourced = make_world(source);
    setup.given_start = start_in(setup.sourced, source);
    const Eigen::Vector3d around =
        sim::free_start(setup.sourced.world, source.resolution, setup.sourced.kind != WorldKind::kMesh);
    setup.truth = std::make_unique<const sim::GroundTruth>(setup.sourced.world, source.resolution, around);
    for (const RobotDescription& robot : setup.head.robots) check_travel(robot, *setup.truth);
    find_starts(given, around, setup);
    for (std::size_t r = 0; r < setup.head.robots.size(); ++r)
      setup.exploration.team[r].robot = setup.head.robots[r].robot;
    setup.head.world = setup.sourced.world.name;
    setup.head.resolution = source.resolution;
  });
  setup.head.bounds = setup.truth->bounds();
  setup.head.observable = setup.truth->observable_voxels();
  setup.head.bounding = setup.truth->bounding_voxels();
  setup.head.options = json_text(options);
  return setup;
}

}  // namespace frontlux::app
