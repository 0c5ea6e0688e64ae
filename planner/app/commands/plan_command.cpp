#include "commands/plan_command.hpp"

#include "bad_input.hpp"
#include "map_file.hpp"
#include "text.hpp"

#include <frontlux/field_of_view.hpp>
#include <frontlux/io/path_file.hpp>
#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/path_optimizer.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/position_refinement.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/planner/visible_pairs.hpp>
#include <frontlux/ray_caster.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace frontlux::app {
namespace {

using planner::PathOptions;
using planner::PathOutcome;
using planner::PathPlan;
using planner::PathSearch;
using planner::Pose;
using planner::TravelCorridor;
using planner::TravelOptions;

struct Options {
  std::string map, robot, from, to, output;  // as written
  std::string search = "rrt", seed = "1", ground = "on", min_height = "1.2";
  std::string iterations;
  std::string optimize = "on", mode = "default", move = "off";
};

std::vector<double> parse_numbers(std::string_view name, std::string_view text) {
  std::vector<double> numbers;
  for (std::string_view rest = text;; rest.remove_prefix(rest.find(',') + 1)) {
    numbers.push_back(parse_number(name, rest.substr(0, rest.find(','))));
    if (rest.find(',') == std::string_view::npos) return numbers;
  }
}

struct Place {
  Pose pose;
  bool has_yaw = true;
};

Place parse_place(const std::string& name, const std::string& text, bool needs_yaw) {
  const auto numbers = parse_numbers(name, text);
  if (numbers.size() != 4 && (needs_yaw || numbers.size() != 3))
    throw BadInput(name + ": '" + text + "' is not " +
                   (needs_yaw ? "four numbers" : "three or four numbers") +
                   "; give x,y,z in metres and the yaw in radians, as in " + name + "=1.5,-2,0.75" +
                   (needs_yaw ? ",0" : ""));
  Place place;
  place.pose.position = {numbers[0], numbers[1], numbers[2]};
  place.has_yaw = numbers.size() == 4;
  if (place.has_yaw) place.pose.yaw = numbers[3];
  return place;
}

template <class Number>
Number parse_whole(const char* name, const std::string& text, Number low, Number high) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || number < low ||
      number > high)
    throw BadInput(std::string(name) + ": '" + text + "' is not a whole number from " + std::to_string(low) +
                   " to " + std::to_string(high));
  return number;
}

PathSearch parse_search(const std::string& text) {
  std::string names;
  for (const PathSearch search :
       {PathSearch::kRrt, PathSearch::kRrtConnect, PathSearch::kRrtStar, PathSearch::kCorridor}) {
    if (text == planner::name_of(search)) return search;
    names.append(names.empty() ? "" : ", ").append(planner::name_of(search));
  }
  throw BadInput("--planner: '" + text + "' is none; those are " + names);
}

PathOptions path_options(const Options& options) {
  PathOptions path;
  path.search = parse_search(options.search);
  constexpr int kOfRrtStar = 2000, kMost = 1'000'000;
  if (path.search == PathSearch::kRrtStar) path.iterations = kOfRrtStar;
  if (!options.iterations.empty())
    path.iterations = parse_whole<int>("--iterations", options.iterations, 1, kMost);
  return path;
}

TravelOptions travel_options(const Options& options) {
  if (options.ground != "on" && options.ground != "off")
    throw BadInput("--require-ground: '" + options.ground + "' is neither on nor off");
  if (options.robot == "ugv") {
    TravelOptions travel = planner::ugv_travel();
    travel.require_ground = options.ground == "on";
    return travel;
  }
  if (options.robot != "uav") throw BadInput("--robot: '" + options.robot + "' is neither ugv nor uav");
  TravelOptions travel = planner::uav_travel();
  travel.min_height = parse_number("--min-height", options.min_height);
  return travel;
}

VoxelKey voxel_of(const Lattice& lattice, const std::string& name, const std::string& text,
                  const Pose& pose) {
  const auto x = lattice.key(pose.position.x()), y = lattice.key(pose.position.y()),
             z = lattice.key(pose.position.z());
  if (!x || !y || !z)
    throw BadInput(name + ": " + text + " lies outside the map's key range, which ends " +
                   rounded(Lattice::kOrigin * lattice.resolution()) + " m from its origin");
  return {*x, *y, *z};
}

TravelCorridor make_corridor(const Options& options, TravelOptions travel, const VoxelGrid& grid,
                             const VoxelKey& robot) {
  const auto bounds = grid.known_bounds();
  if (!bounds) throw BadInput(options.map + ": every voxel is unknown, so there is nowhere to go");
  travel.without_ground = {{robot, robot}};  // no sensor sees the floor that it starts on
  try {
    TravelCorridor corridor(travel, grid.lattice(), *bounds);
    corridor.update(grid, {}, robot);
    return corridor;
  } catch (const std::invalid_argument& error) {
    throw BadInput(options.map + ": " + error.what());
  } catch (const std::bad_alloc&) {
    throw BadInput(options.map + ": its corridor does not fit into this machine's memory");
  }
}

[[noreturn]] void complain(const Options& options, const TravelCorridor& corridor, const PathPlan& plan) {
  if (corridor.state() != planner::CorridorState::kReady)
    throw BadInput("--from: at " + options.from + " the " + options.robot + " " +
                   std::string(planner::describe(corridor.state())) + "; give another start");
  const std::string advice = options.robot == "ugv" && options.ground == "on"
                                 ? "give another goal, or --require-ground off"
                                 : "give another goal";
  throw BadInput("--to: the path to " + options.to + " " + std::string(planner::describe(plan.outcome)) +
                 "; " + advice);
}

// What would fail in the end fails before the work.
void check_output(const std::filesystem::path& file) {
  if (file.empty()) return;
  if (file.extension() != ".csv" && file.extension() != ".ply")
    throw BadInput("--output: " + file.string() +
                   " is no name for a path; give one that ends in .csv or .ply");
  std::error_code error;
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, error))
    throw BadInput("--output: there is no folder " + folder.string() + "; make it first");
}

// Without a wish the robot arrives looking the way it came.
void look_ahead(std::vector<Pose>& viewpoints) {
  Pose& goal = viewpoints.back();
  goal.yaw = viewpoints.front().yaw;
  for (std::size_t i = viewpoints.size() - 1; i > 0; --i) {
    const Eigen::Vector3d step = viewpoints[i].position - viewpoints[i - 1].position;
    if (step.x() == 0.0 && step.y() == 0.0) continue;
    goal.yaw = std::atan2(step.y(), step.x());
    return;
  }
}

// What the paper's robots see with.
FieldOfView view_of(const std::string& robot) {
  using std::numbers::pi;
  if (robot == "ugv") return {FieldOfView::Shape::kSpinning, 0.0, 2.0 * pi / 9.0, 6.0};
  return {FieldOfView::Shape::kPyramid, pi / 2.0, 2.0 * pi / 5.0, 10.0};
}

planner::PathOptimizerOptions optimizer_options(const Options& options) {
  if (options.optimize != "on" && options.optimize != "off")
    throw BadInput("--optimize: '" + options.optimize + "' is neither on nor off");
  if (options.mode == "paper") return planner::paper_path_options();
  if (options.mode != "default")
    throw BadInput("--mode: '" + options.mode + "' is neither default nor paper");
  return {};
}

void check_move(const Options& options) {
  if (options.move != "on" && options.move != "off")
    throw BadInput("--move: '" + options.move + "' is neither on nor off");
  if (options.move == "on" && options.optimize == "off")
    throw BadInput("--move: on needs --optimize on, since viewpoints that move also turn");
}

// The part of the known map from which frontiers can be in view somewhere along the path.
KeyBox surroundings(const VoxelGrid& grid, const std::vector<Pose>& viewpoints, double range) {
  KeyBox box = *grid.known_bounds();
  const auto clip = [&](int axis, std::uint16_t& low, std::uint16_t& high) {
    double least = viewpoints.front().position[axis], most = least;
    for (const Pose& viewpoint : viewpoints) {
      least = std::min(least, viewpoint.position[axis]);
      most = std::max(most, viewpoint.position[axis]);
    }
    if (const auto key = grid.lattice().key(least - range)) low = std::max(low, *key);
    if (const auto key = grid.lattice().key(most + range)) high = std::min(high, *key);
  };
  clip(0, box.min.x, box.max.x);
  clip(1, box.min.y, box.max.y);
  clip(2, box.min.z, box.max.z);
  return box;
}

struct Turned {
  planner::OptimizedPath path;
  std::optional<planner::RefinedPath> moved;
  double milliseconds = 0.0, moving_milliseconds = 0.0;
};

double milliseconds_since(std::chrono::steady_clock::time_point before) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
}

// Turns the viewpoints between the ends so that they see more, and then moves them, if that is wanted.
Turned turn(const Options& options, const planner::PositionOptions& position, const VoxelGrid& grid,
            const TravelCorridor& corridor, const planner::TravelOptions& travel,
            std::vector<Pose>& viewpoints) {
  const bool move = options.move == "on";
  const FieldOfView view = view_of(options.robot);
  const auto caster = make_ray_caster(grid);
  const double range = view.max_range + (move ? position.max_shift : 0.0);
  const planner::FrontierSet frontiers(grid, surroundings(grid, viewpoints, range));
  auto before = std::chrono::steady_clock::now();
  const auto pairs = planner::visible_pairs(*caster, grid, viewpoints, frontiers.keys(), view);
  const auto centers = planner::centers(grid.lattice(), frontiers.keys());
  Turned turned;
  turned.path = planner::optimize_path(viewpoints, centers, pairs, view, position.optimizer);
  turned.milliseconds = milliseconds_since(before);
  for (std::size_t i = 0; i < viewpoints.size(); ++i) viewpoints[i].yaw = turned.path.yaws[i];
  if (!move) return turned;
  before = std::chrono::steady_clock::now();
  turned.moved = planner::refine_positions(viewpoints, frontiers.keys(), *caster, grid, corridor,
                                           {options.robot, travel, view}, position);
  turned.moving_milliseconds = milliseconds_since(before);
  viewpoints = turned.moved->viewpoints;
  return turned;
}

void plan(const Options& options) {
  const PathOptions path = path_options(options);
  const TravelOptions travel = travel_options(options);
  const auto seed = parse_whole<std::uint64_t>("--seed", options.seed, 0, UINT64_MAX);
  const Place from = parse_place("--from", options.from, true), to = parse_place("--to", options.to, false);
  planner::PositionOptions position;
  position.optimizer = optimizer_options(options);
  position.spacing = path.spacing;
  check_move(options);
  check_output(options.output);

  const VoxelGrid grid = make_voxel_grid(read_map_file(options.map));
  const VoxelKey robot = voxel_of(grid.lattice(), "--from", options.from, from.pose);
  const VoxelKey goal = voxel_of(grid.lattice(), "--to", options.to, to.pose);
  if (options.robot == "ugv" && goal.z != robot.z) {
    const double half = grid.resolution() / 2, middle = grid.lattice().center(robot.z);
    throw BadInput("--to: " + options.to + " is not on the ugv's plane, where z is from " +
                   rounded(middle - half) + " to " + rounded(middle + half) + " m; give the z of --from");
  }
  const TravelCorridor corridor = make_corridor(options, travel, grid, robot);

  const auto before = std::chrono::steady_clock::now();
  PathPlan found = planner::plan_path(corridor, grid.lattice(), from.pose, to.pose, {seed, 0, 0}, path);
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - before;
  if (!found.found()) complain(options, corridor, found);
  if (!to.has_yaw) look_ahead(found.viewpoints);
  std::optional<Turned> turned;
  if (options.optimize == "on") {
    const double first = found.viewpoints.front().yaw, last = found.viewpoints.back().yaw;
    turned = turn(options, position, grid, corridor, travel, found.viewpoints);
    found.viewpoints.front().yaw = first;  // to the last bit, by how many turns whatever
    found.viewpoints.back().yaw = last;
    found.length = turned->moved ? planner::path_length(found.viewpoints) : found.length;
  }

  try {
    if (!options.output.empty()) planner::write_path(options.output, found.viewpoints);
  } catch (const std::runtime_error& error) {
    throw BadInput(std::string("--output: ") + error.what());
  }
  std::cout << row("map", options.map)
            << row("robot",
                   options.robot + ", " + std::to_string(corridor.cells().size()) + " cells within its reach")
            << row("path", "the path " + std::string(planner::describe(found.outcome)))
            << row("length", rounded(found.length) + " m")
            << row("viewpoints", std::to_string(found.viewpoints.size()))
            << row("planner", std::string(planner::name_of(path.search)) + ", " +
                                  std::to_string(found.iterations) + " iterations")
            << row("time", rounded(std::round(time.count() * 1e3) / 1e3) + " ms");
  if (turned) {
    const auto& [path_turned, moved, milliseconds, moving_milliseconds] = *turned;
    std::cout << row("gain", std::to_string(path_turned.tangent.distinct) + " frontiers in view before, " +
                                 std::to_string(path_turned.result.distinct) + " after; fuzzy " +
                                 rounded(path_turned.tangent.fuzzy) + " before, " +
                                 rounded(path_turned.result.fuzzy) + " after")
              << row("optimiser", std::string(planner::describe(path_turned.end)) + ", " +
                                      std::to_string(path_turned.evaluations) + " evaluations, " +
                                      rounded(std::round(milliseconds * 1e3) / 1e3) + " ms");
    if (moved)
      std::cout << row("moved", std::to_string(moved->before.distinct) + " frontiers in view before, " +
                                    std::to_string(moved->after.distinct) + " after; fuzzy " +
                                    rounded(moved->before.fuzzy) + " before, " + rounded(moved->after.fuzzy) +
                                    " after; " + std::to_string(moved->outer_iterations) +
                                    " iterations kept, " + std::to_string(moved->rays) + " rays, " +
                                    rounded(std::round(moving_milliseconds * 1e3) / 1e3) + " ms");
  }
  if (!options.output.empty()) std::cout << row("written", options.output);
}

}  // namespace

void add_plan_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("plan", "Plan a robot's path through a map");
  const auto options = std::make_shared<Options>();
  command->add_option("MAP", options->map, "OctoMap file, .bt or .ot")->required();
  command->add_option("--robot", options->robot, "ugv: 1.0 x 1.0 x 0.7 m on the ground; uav: a cube of 0.8 m")
      ->required()
      ->type_name("ROBOT");
  command->add_option("--from", options->from, "Where the robot's sensor is [m] and looks [rad]")
      ->required()
      ->type_name("X,Y,Z,YAW");
  command->add_option("--to", options->to, "Where it goes; without a yaw it arrives looking ahead")
      ->required()
      ->type_name("X,Y,Z[,YAW]");
  command
      ->add_option("--planner", options->search,
                   "rrt, rrt-connect, rrt-star, or the corridor's shortest path")
      ->type_name("NAME")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the random search: the same seed gives the same path")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--iterations", options->iterations,
                   "Of the search before it falls back on the corridor (default: 20000; rrt-star: 2000)")
      ->type_name("N");
  command
      ->add_option("--require-ground", options->ground,
                   "ugv: go only where the floor is known (on), or also where it is not (off)")
      ->type_name("ON|OFF")
      ->capture_default_str();
  command->add_option("--min-height", options->min_height, "uav: of its centre above z = 0 [m]")
      ->type_name("M")
      ->capture_default_str();
  command
      ->add_option(
          "--optimize", options->optimize,
          "Turn the viewpoints between the ends so that they see more frontiers (on), or let them look "
          "ahead (off)")
      ->type_name("ON|OFF")
      ->capture_default_str();
  command
      ->add_option("--move", options->move,
                   "Also move the viewpoints between the ends, by 0.6 m at most (on), or not (off)")
      ->type_name("ON|OFF")
      ->capture_default_str();
  command
      ->add_option(
          "--mode", options->mode,
          "Of the optimisation: each frontier counts once (default), or as the paper prints it (paper)")
      ->type_name("NAME")
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "Write the viewpoints here: .csv, or .ply to look at")
      ->type_name("FILE");
  command->footer(
      "Example:\n"
      "  frontlux plan building.bt --robot uav --from 0,0,1.5,0 --to 8,3,2 -o path.csv\n"
      "plans a path on which the robot fits, as far as the map knows, and writes viewpoints at most 1.2 m\n"
      "apart. A ugv's sensor is 0.75 m above the floor, and so are both ends of its path.");
  command->callback([options] { plan(*options); });
}

}  // namespace frontlux::app
