#include "bad_input.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "commands/output_file.hpp"
#include "commands/robot_option.hpp"
#include "map_file.hpp"
#include "terminal.hpp"
#include "text.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/io/path_file.hpp>
#include <frontlux/key_box.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/path_optimizer.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/position_refinement.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/planner/visible_pairs.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/stopwatch.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::app {
namespace {

using planner::Motion, planner::PathOptions, planner::PathPlan, planner::PathSearch, planner::Pose,
    planner::TravelCorridor, planner::TravelOptions;

// An end of the path, as the user gives it.
struct End {
  std::string word;
  Pose pose;
  bool has_yaw = true;
};

void read_end(std::string_view word, End& end, bool needs_yaw) {
  const auto numbers = numbers_in(word);
  if (!numbers || (numbers->size() != 4 && (needs_yaw || numbers->size() != 3)))
    throw BadInput(quote(word) + " is not " + (needs_yaw ? "four" : "three or four") +
                   " finite numbers; give x,y,z in metres and the yaw in radians, as in 1.5,-2,0.75,0");
  end.word = word;
  end.pose.position = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  end.has_yaw = numbers->size() == 4;
  if (!end.has_yaw) return;
  check_yaw(word, (*numbers)[3]);
  end.pose.yaw = (*numbers)[3];
}
struct From : End {};
struct To : End {};
void read(std::string_view word, From& from) { read_end(word, from, true); }
void read(std::string_view word, To& to) { read_end(word, to, false); }

struct Options {
  std::string map, output;
  RobotWord robot;
  std::optional<Eigen::AlignedBox3d> bounds;
  From from;
  To to;
  std::optional<bool> require_ground;
  std::optional<double> min_height;
  PathSearch search = PathSearch::kRrt;
  std::optional<std::uint64_t> seed;
  std::optional<int> iterations;
  bool optimize = true, move = false;
  std::optional<planner::Method> mode;
};

void refuse(bool given, const char* option, const std::string& why) {
  if (given) throw BadInput(std::string(option) + ": " + why + "; leave the option out");
}

// Options that would change nothing beside the others.
void check_options(const Options& options) {
  if (options.search == PathSearch::kCorridor) {
    refuse(options.iterations.has_value(), "--iterations", "the corridor's shortest path takes none");
    refuse(options.seed.has_value(), "--seed", "the corridor's shortest path is not random");
  }
  if (!options.optimize) {
    refuse(options.move, "--move", "viewpoints only move with --optimize on");
    refuse(options.mode.has_value(), "--mode", "it is a mode of --optimize on");
  }
}

PathOptions path_options(const Options& options) {
  PathOptions path = planner::path_options(options.search);
  path.iterations = options.iterations.value_or(path.iterations);
  return path;
}

planner::Robot make_robot(const Options& options) {
  planner::Robot robot = describe(options.robot).robot;
  TravelOptions& travel = robot.travel;
  const std::string name = "the " + robot.name;
  refuse(options.min_height && travel.drives(), "--min-height", name + " stays on the ground");
  refuse(options.require_ground && travel.motion == Motion::kSpace, "--require-ground",
         name + " needs no ground");
  refuse(options.require_ground && travel.motion == Motion::kGround, "--require-ground",
         name + " goes up and down, and only where ground is known");
  travel.min_height = options.min_height.value_or(travel.min_height);
  travel.require_ground = options.require_ground.value_or(travel.require_ground);
  return robot;
}

VoxelKey voxel_of(const Lattice& lattice, const char* name, const End& end) {
  const auto key = lattice.key(end.pose.position);
  if (!key)
    throw BadInput(std::string(name) + ": " + end.word + " lies outside the map's key range, which ends " +
                   rounded(Lattice::kOrigin * lattice.resolution()) + " m from its origin");
  return *key;
}

TravelCorridor make_corridor(TravelOptions travel, const VoxelGrid& grid, const KeyBox& bounds,
                             const VoxelKey& robot) {
  travel.without_ground = {{robot, robot}};  // no sensor sees the floor that it starts on
  TravelCorridor corridor(travel, grid.lattice(), bounds);
  corridor.update({grid}, robot);
  return corridor;
}

[[noreturn]] void complain(const Options& options, const planner::Robot& robot,
                           const TravelCorridor& corridor, const PathPlan& plan) {
  const char* ground_advice =
      robot.travel.motion == Motion::kPlane && robot.travel.require_ground ? ", or --require-ground off" : "";
  if (corridor.state() != planner::CorridorState::kReady)
    throw BadInput("--from: at " + options.from.word + " the " + robot.name + " " +
                   std::string(planner::describe(corridor.state())) + "; give another start" +
                   (corridor.state() == planner::CorridorState::kWithoutGround ? ground_advice : ""));
  throw BadInput("--to: the path to " + options.to.word + " " + std::string(planner::describe(plan.outcome)) +
                 "; give another goal" + ground_advice);
}

// Without a yaw of --to the robot looks ahead when it arrives.
void look_ahead(std::vector<Pose>& viewpoints) {
  Pose& goal = viewpoints.back();
  goal.yaw = viewpoints.front().yaw;
  for (std::size_t i = 1; i < viewpoints.size(); ++i)
    goal.yaw = planner::yaw_along(viewpoints[i].position - viewpoints[i - 1].position, goal.yaw);
}

// The part of the known map from which frontiers can be in view somewhere along the path.
KeyBox surroundings(const VoxelGrid& grid, const std::vector<Pose>& viewpoints, double range) {
  Eigen::AlignedBox3d box;
  for (const Pose& viewpoint : viewpoints) box.extend(viewpoint.position);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(range);
  const KeyBox around = planner::voxels_of(grid.lattice(), {box.min() - reach, box.max() + reach});
  return intersection(around, grid.known_bounds().value()).value();
}

// What became of the viewpoints between the ends.
struct Optimized {
  planner::OptimizedPath turned;
  std::optional<planner::RefinedPath> moved;
  double turn_ms = 0.0, move_ms = 0.0;
};

// Turns the viewpoints between the ends so that they see more, and then moves them if --move is on.
Optimized optimize(const Options& options, const planner::Robot& robot, const VoxelGrid& grid,
                   const TravelCorridor& corridor, PathPlan& path) {
  planner::PositionOptions position;
  if (options.mode == planner::Method::kPaper) position.optimizer = planner::paper_optimizer_options();
  position.spacing = path_options(options).spacing;
  std::vector<Pose>& viewpoints = path.viewpoints;
  const double first_yaw = viewpoints.front().yaw, last_yaw = viewpoints.back().yaw;
  const auto caster = make_ray_caster(grid);
  const double range = robot.view.max_range + (options.move ? position.max_shift : 0.0);
  const FrontierSet frontiers(grid, surroundings(grid, viewpoints, range));

  Optimized result;
  const Stopwatch turning;
  const auto pairs = planner::visible_pairs(*caster, grid, viewpoints, frontiers.keys(), robot.view);
  const auto centers = planner::centers(grid.lattice(), frontiers.keys());
  result.turned = planner::optimize_path(viewpoints, centers, pairs, robot.view, position.optimizer);
  result.turn_ms = turning.milliseconds();
  for (std::size_t i = 0; i < viewpoints.size(); ++i) viewpoints[i].yaw = result.turned.yaws[i];
  if (options.move) {
    const Stopwatch moving;
    result.moved =
        planner::refine_positions(viewpoints, frontiers.keys(), *caster, grid, corridor, robot, position);
    result.move_ms = moving.milliseconds();
    viewpoints = result.moved->viewpoints;
    path.length = planner::path_length(viewpoints);
  }
  viewpoints.front().yaw = first_yaw;  // as given, without the optimizer's wrapping to [-pi, pi]
  viewpoints.back().yaw = last_yaw;
  return result;
}

std::string gain_text(const planner::PathGain& before, const planner::PathGain& after) {
  return std::to_string(before.distinct) + " frontiers in view before, " + std::to_string(after.distinct) +
         " after; fuzzy " + rounded(before.fuzzy) + " before, " + rounded(after.fuzzy) + " after";
}

void print(const Options& options, const planner::Robot& robot, const TravelCorridor& corridor,
           const PathPlan& path, double path_ms, const std::optional<Optimized>& optimized) {
  std::cout << row("map", options.map)
            << row("robot", robot.name + ", " + std::to_string(corridor.cells().size()) + " reachable cells")
            << row("path", "the path " + std::string(planner::describe(path.outcome)))
            << row("length", rounded(path.length) + " m")
            << row("viewpoints", std::to_string(path.viewpoints.size()))
            << row("planner", std::string(planner::name_of(options.search)) + ", " +
                                  std::to_string(path.iterations) + " iterations")
            << row("time", fixed(path_ms, 3) + " ms");
  if (optimized) {
    const auto& [turned, moved, turn_ms, move_ms] = *optimized;
    std::cout << row("gain", gain_text(turned.tangent, turned.result))
              << row("optimizer", std::string(planner::describe(turned.end)) + ", " +
                                      std::to_string(turned.evaluations) + " evaluations, " +
                                      fixed(turn_ms, 3) + " ms");
    if (moved)
      std::cout << row("moved", gain_text(moved->before, moved->after) + "; " +
                                    std::to_string(moved->outer_iterations) + " iterations kept, " +
                                    std::to_string(moved->rays) + " rays, " + fixed(move_ms, 3) + " ms");
  }
  if (!options.output.empty()) std::cout << row("written", options.output);
}

void plan(const Options& options) {
  check_options(options);
  if (!options.output.empty())
    check_output(options.output, {".csv", ".ply"}, std::array{options.map, options.robot.word});
  const planner::Robot robot = make_robot(options);
  const MapFile map = read_map_file(options.map);
  const VoxelGrid grid = make_grid(map);
  check(options.robot, robot, grid.lattice());
  const VoxelKey start = voxel_of(grid.lattice(), "--from", options.from);
  const VoxelKey goal = voxel_of(grid.lattice(), "--to", options.to);
  if (robot.travel.motion == Motion::kPlane && goal.z != start.z) {
    const double half = grid.resolution() / 2, middle = grid.lattice().center(start.z);
    throw BadInput("--to: " + options.to.word + " is not on the plane of the " + robot.name +
                   ", where z is from " + rounded(middle - half) + " to " + rounded(middle + half) +
                   " m; give the z of --from");
  }
  const KeyBox space = robot_space(map, grid, options.bounds, robot.travel.motion);
  std::optional<WorkingLine> working(std::in_place, "planning");
  const TravelCorridor corridor = make_corridor(robot.travel, grid, space, start);
  const Stopwatch planning;
  PathPlan path = planner::plan_path(corridor, grid.lattice(), options.from.pose, options.to.pose,
                                     {options.seed.value_or(1), 0, 0}, path_options(options));
  const double path_ms = planning.milliseconds();
  if (!path.found()) complain(options, robot, corridor, path);
  if (!options.to.has_yaw) look_ahead(path.viewpoints);
  std::optional<Optimized> optimized;
  if (options.optimize) optimized = optimize(options, robot, grid, corridor, path);
  working.reset();
  if (!options.output.empty()) io::write_path(options.output, path.viewpoints);
  print(options, robot, corridor, path, path_ms, optimized);
}

}  // namespace

void add_plan_command(CLI::App& app) {
  Command command(app, "plan", "Plan a robot's path through a map");
  const auto options = std::make_shared<Options>();
  command.add("MAP", options->map, "", "OctoMap file, .bt or .ot").required();
  command.add("-o,--output", options->output, "FILE", "Write the viewpoints, as .csv or .ply");
  command.add("--bounds", options->bounds, "X,Y,Z,X,Y,Z",
              "Part of the map to drive or fly in: its lowest and its highest corner [all]");
  command.group("Robot");
  command
      .add("--robot", options->robot, "ugv|uav|FILE",
           "Ground robot of 1.0 x 1.0 x 0.7 m, aerial robot of 0.8 m, or one described in a .json file")
      .required();
  command.add("--from", options->from, "X,Y,Z,YAW", "Pose of the robot's sensor at the start").required();
  command.add("--to", options->to, "X,Y,Z[,YAW]", "Pose at the goal; without a yaw it looks ahead")
      .required();
  command.add("--require-ground", options->require_ground,
              "On a plane: drive only where the floor is known [on, or as in the file]");
  command.add("--min-height", options->min_height, "METRES",
              "In space: least height of its centre above z = 0 [1.2, or as in the file]", kAnyNumber);
  command.group("Path search");
  command.add("--planner", options->search, "Search method; corridor: the corridor's shortest path");
  command.add("--seed", options->seed, "N", "Random seed of the search [1]", kSeeds);
  command.add("--iterations", options->iterations, "N",
              "Limit of the search; then the corridor's path is taken [20000; rrt-star: 2000]",
              Range<int>{1, 1'000'000});
  command.group("View optimization");
  command.add("--optimize", options->optimize, "Turn the viewpoints so that they see more frontiers");
  command.add("--move", options->move, "Also move the viewpoints, by 0.6 m at most");
  command.add("--mode", options->mode, "Count each frontier once, or as printed in the paper [default]");
  command.examples(R"(Example:
  frontlux plan building.bt --robot uav --from 0,0,1.5,0 --to 8,3,2 -o path.csv
plans a path on which the robot fits in known free space, and writes viewpoints at most 1.2 m apart.
The sensor of a ugv is 0.75 m above the floor at both ends of its path.)");
  command.run(
      [options] { work_on(options->map, "give a map of a coarser resolution", [&] { plan(*options); }); });
}

}  // namespace frontlux::app
