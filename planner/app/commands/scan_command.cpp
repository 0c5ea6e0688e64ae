#include "commands/scan_command.hpp"

#include "bad_input.hpp"
#include "explore/interrupt.hpp"
#include "map_output.hpp"
#include "progress_line.hpp"
#include "text.hpp"
#include "world_source.hpp"

#include <frontlux/io/pose_file.hpp>
#include <frontlux/planner/look_around.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/sim/coverage.hpp>
#include <frontlux/sim/scan_world.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <CLI/CLI.hpp>

#include <chrono>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::app {
namespace {

using planner::Mapping;
using planner::Pose;
using planner::RobotDescription;
using sim::GroundTruth;
using sim::View;
using Clock = std::chrono::steady_clock;

constexpr double kSpacing = 2.5;  // [m]

struct Options {
  WorldSource source;
  std::optional<std::string> seed, poses, noise, dropout;
  std::vector<std::string> sweep;  // the spacing, if it is given
  std::string resolution = "0.3", robot = "both", output;
};

// What is to be scanned: the start bubbles, and from where.
struct Plan {
  std::vector<RobotDescription> robots;
  std::vector<VoxelKey> bubble;
  std::vector<View> views;
  std::string starts;  // rows of the summary
};

std::vector<RobotDescription> robots_of(const Options& options) {
  if (options.robot == "ugv") return {planner::ugv_description()};
  if (options.robot == "uav") return {planner::uav_description()};
  if (options.robot == "both") return {planner::ugv_description(), planner::uav_description()};
  throw BadInput("--robot: '" + options.robot + "' is not ugv, uav or both");
}

sim::ScanWorldOptions scan_options(const Options& options) {
  sim::ScanWorldOptions scan;
  if (options.seed) scan.seed = parse_seed(*options.seed);
  if (options.noise) scan.errors.sigma = parse_number("--noise", *options.noise);
  if (scan.errors.sigma < 0.0)
    throw BadInput("--noise: " + *options.noise + " m is no standard deviation; give 0 or more");
  if (options.dropout) scan.errors.dropout = parse_number("--dropout", *options.dropout);
  if (!(scan.errors.dropout >= 0.0 && scan.errors.dropout <= 1.0))
    throw BadInput("--dropout: " + *options.dropout + " is no probability; give 0 to 1");
  return scan;
}

GroundTruth make_truth(const SourcedWorld& sourced, double resolution) {
  try {
    return {sourced.world, resolution,
            sim::free_start(sourced.world, resolution, sourced.kind != WorldKind::kMesh)};
  } catch (const std::invalid_argument& error) {
    throw BadInput(sourced.world.name + ": " + error.what());
  }
}

void add_listed_views(const Options& options, const std::vector<io::ListedPose>& poses,
                      const GroundTruth& truth, Plan& plan) {
  for (const auto& [pose, line] : poses) {
    const Eigen::Vector3d& at = pose.position;
    const auto refuse = [&, line = line](const std::string& why) {
      throw BadInput(*options.poses + ": line " + std::to_string(line) + ": the sensor at " +
                     rounded(at.x()) + ", " + rounded(at.y()) + ", " + rounded(at.z()) + " m " + why);
    };
    const auto x = truth.lattice().key(at.x()), y = truth.lattice().key(at.y()),
               z = truth.lattice().key(at.z());
    if (!x || !y || !z || !truth.bounds().contains({*x, *y, *z})) refuse("is outside of the world's bounds");
    if (truth.holds_surface({*x, *y, *z}))
      refuse("is in a wall: a surface passes through its voxel; move it, or give a smaller --resolution");
    if (truth.at({*x, *y, *z}) != sim::Truth::kFree)
      refuse("cannot be reached from the start: it is in a solid, or in a closed room");
    for (std::size_t i = 0; i < plan.robots.size(); ++i) plan.views.push_back({i, pose});
  }
}

void add_sweep(const Options& options, const GroundTruth& truth, const Eigen::Vector3d& around, Plan& plan) {
  const double spacing = options.sweep.empty() || options.sweep[0].empty()
                             ? kSpacing
                             : parse_length("--sweep", options.sweep[0]);
  std::vector<planner::Robot> robots;
  for (const RobotDescription& robot : plan.robots) robots.push_back(robot.robot);
  const auto starts = sim::find_starts(truth, around, robots);
  std::vector<View> after;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const char* name = robots[i].name == "ugv" ? "UGV" : "UAV";
    const std::optional<Pose>& pose = starts[i];
    if (!pose) {
      std::string why = std::string(name) + ": the robot has no place within 15 m of the start";
      if (robots.size() == 1) throw BadInput(why + "; give another --start");
      plan.starts += row(name, why.substr(why.find("no place")) + ": left out");
      continue;
    }
    plan.starts += row(name, "starts at " + to_text(Eigen::Vector3f(pose->position.cast<float>())) + " m");
    const auto bubble = sim::start_bubble(truth, robots[i], *pose);
    plan.bubble.insert(plan.bubble.end(), bubble.begin(), bubble.end());
    for (const Pose& view : planner::look_around(robots[i].view, *pose)) plan.views.push_back({i, view});
    for (const Pose& view : sim::sweep(truth, robots[i], *pose, spacing)) after.push_back({i, view});
  }
  if (plan.views.empty())
    throw BadInput(options.source.world +
                   ": neither robot has a place within 15 m of the start; give another --start");
  plan.views.insert(plan.views.end(), after.begin(), after.end());
}

// @throws Interrupted
void scan(const SourcedWorld& sourced, const GroundTruth& truth, const Plan& plan,
          const sim::ScanWorldOptions& options, Mapping& mapping) {
  const InterruptNote note;
  const ProgressLine progress;
  constexpr std::chrono::milliseconds kBetweenLooks{500};
  auto next_look = Clock::now();
  std::string covered;
  const auto report = [&](std::size_t done) {
    if (progress.visible()) {
      if (Clock::now() >= next_look) {
        covered = rounded(std::round(1000 * sim::measure(truth, mapping.grid()).of_observable()) / 10) + " %";
        next_look = Clock::now() + kBetweenLooks;
      }
      progress.show("scan " + std::to_string(done) + " of " + std::to_string(plan.views.size()) + ", " +
                    covered + " of the observable space known");
    }
    return !InterruptNote::taken();
  };
  mapping.mark_free(plan.bubble);
  sim::scan_world(sim::Surface(sourced.world.mesh), plan.robots, plan.views, options, mapping, report);
  if (InterruptNote::taken()) throw Interrupted();
}

std::string percent(double share) { return rounded(std::round(share * 1e4) / 100) + " %"; }

void print_summary(const Options& options, const SourcedWorld& sourced, const GroundTruth& truth,
                   const Plan& plan, const Mapping& mapping, double seconds) {
  const auto voxels = mapping.grid().count();
  const sim::Coverage coverage = sim::measure(truth, mapping.grid());
  std::string out = row("map", options.output) + row("world", sourced.world.name);
  if (sourced.kind == WorldKind::kBuiltIn) out += row("seed", std::to_string(sourced.seed));
  if (options.source.ground) out += row("ground", "moved by " + rounded(sourced.ground_shift) + " m along z");
  out += row("resolution", to_text(mapping.grid().resolution()) + " m") + plan.starts +
         row("scans", std::to_string(plan.views.size())) +
         row("free", std::to_string(voxels[1]) + " voxels") +
         row("occupied", std::to_string(voxels[2]) + " voxels") +
         row("unknown", std::to_string(coverage.bounding - coverage.known_bounding) + " voxels") +
         row("coverage", percent(coverage.of_observable()) + " of the observable space, " +
                             percent(coverage.of_bounding()) + " of the world's box") +
         row("time", rounded(std::round(seconds * 1e3) / 1e3) + " s");
  std::cout << out;
}

void run(Options& options) {
  const auto begin = Clock::now();
  options.source.resolution = parse_resolution(options.resolution);
  Plan plan;
  plan.robots = robots_of(options);
  const sim::ScanWorldOptions scan_with = scan_options(options);
  if (is_built_in_world(options.source.world)) options.source.seed = options.seed;
  check_map_output(options.output);
  std::vector<io::ListedPose> poses;
  if (options.poses) poses = io::read_pose_list(*options.poses);

  SourcedWorld sourced = make_world(options.source);
  for (auto& [pose, line] : poses) pose.position.z() += sourced.ground_shift;
  // Without a start, what can be seen begins where the first sensor is.
  if (!sourced.world.start && !poses.empty()) {
    const Eigen::Vector3d& first = poses.front().pose.position;
    if (!sourced.world.bounds.contains(first))
      throw BadInput(*options.poses + ": line " + std::to_string(poses.front().line) + ": the sensor at " +
                     rounded(first.x()) + ", " + rounded(first.y()) + ", " + rounded(first.z()) +
                     " m is outside of the world's bounds");
    sourced.world.start = first;
  }
  if (!sourced.world.start)
    throw BadInput(sourced.world.name + ": no start is known; give --start in free space");
  const GroundTruth truth = make_truth(sourced, options.source.resolution);
  if (options.poses)
    add_listed_views(options, poses, truth, plan);
  else
    add_sweep(options, truth, sim::free_start(sourced.world, options.source.resolution, false), plan);
  Mapping mapping({.resolution = options.source.resolution, .bounds = truth.bounds()});
  scan(sourced, truth, plan, scan_with, mapping);
  mapping.write(options.output);
  print_summary(options, sourced, truth, plan, mapping,
                std::chrono::duration<double>(Clock::now() - begin).count());
}

}  // namespace

void add_scan_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("scan", "Map a world with simulated sensors");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("WORLD", options->source.world,
                   "A built-in world (see frontlux world), a mesh file or an OctoMap file")
      ->required();
  command->add_option("-o,--output", options->output, "Map to write, .bt or .ot")->required();
  CLI::Option* poses = command->add_option(
      "--poses", options->poses,
      "File of sensor poses, x,y,z,yaw on each line, in metres and radians, before the ground is aligned");
  CLI::Option* sweep = command
                           ->add_option("--sweep", options->sweep,
                                        "Look from all over the free space, in cubes of this edge in metres, "
                                        "2.5 if not given; the default")
                           ->expected(0, 1)
                           ->type_name("[M]");
  poses->excludes(sweep);
  command
      ->add_option("--robot", options->robot,
                   "Whose sensor: ugv (lidar, 6 m), uav (depth camera, 10 m), or both of them at every pose")
      ->capture_default_str();
  command->add_option("--resolution", options->resolution, "Edge of a voxel in metres")
      ->capture_default_str();
  command->add_option("--seed", options->seed,
                      "Which of a built-in world's layouts, and which errors of the sensors; 1 if not given");
  command->add_option("--noise", options->noise, "Standard deviation of a range in metres; 0 if not given");
  command->add_option("--dropout", options->dropout,
                      "Probability that a ray gives no measurement; 0 if not given");
  add_world_options(*command, options->source);
  command->footer(
      "Examples:\n"
      "  frontlux scan storage --seed 4 -o storage.bt\n"
      "  frontlux scan house.ply --start 1,2,0.5 --ground auto --resolution 0.1 --sweep 1.5 -o house.ot\n"
      "A sweep begins at the robots' starts, near the world's start or --start, and knows to be free what "
      "is\n"
      "right around them. Nothing is written unless all scans are done.");
  command->callback([options] {
    try {
      run(*options);
    } catch (const BadInput&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw BadInput(options->source.world +
                     ": its map does not fit into this machine's memory; give a coarser --resolution");
    } catch (const std::invalid_argument& error) {
      throw BadInput(options->source.world + ": " + error.what());
    } catch (const std::runtime_error& error) {
      throw BadInput(error.what());
    }
  });
}

}  // namespace frontlux::app
