#include "accuracy_text.hpp"
#include "bad_input.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "commands/output_file.hpp"
#include "commands/robot_option.hpp"
#include "commands/sensor_model_option.hpp"
#include "interrupt.hpp"
#include "terminal.hpp"
#include "text.hpp"
#include "world_source.hpp"

#include <frontlux/io/pose_file.hpp>
#include <frontlux/planner/look_around.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/sim/coverage.hpp>
#include <frontlux/sim/scan_world.hpp>
#include <frontlux/sim/start_pose.hpp>
#include <frontlux/stopwatch.hpp>

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::app {
namespace {

using planner::Mapping, planner::Pose, planner::RobotDescription, sim::GroundTruth, sim::View;

// Whose sensors scan.
struct Scanners {
  std::vector<RobotWord> robots{{"ugv"}, {"uav"}};
};
void read(std::string_view word, Scanners& scanners) {
  if (word == "both") return;
  scanners.robots.assign(1, {});
  try {
    read(word, scanners.robots.front());
  } catch (const BadInput& error) {
    throw BadInput(error.what() + std::string("; or give both"));
  }
}

constexpr std::uint64_t kSeed = 1;  // unless one is given

struct Options {
  WorldSource source;
  std::string output, poses;
  double sweep = 2.5;  // [m]
  Scanners scanners;
  std::optional<std::uint64_t> seed;
  sim::RangeErrors errors;
  planner::SensorModel sensor_model = planner::kOctomapSensorModel;
};

// What is to be scanned: the start bubbles, and from where.
struct Plan {
  std::vector<RobotDescription> robots;
  std::vector<VoxelKey> bubble;
  std::vector<View> views;
  std::string starts;  // rows of the summary
};

std::string place_text(const Eigen::Vector3d& at) {
  return rounded(at.x()) + ", " + rounded(at.y()) + ", " + rounded(at.z()) + " m";
}

[[noreturn]] void refuse_pose(const Options& options, const io::ListedPose& pose, const char* why) {
  throw BadInput(options.poses + ": line " + std::to_string(pose.line) + ": the sensor at " +
                 place_text(pose.pose.position) + " " + why);
}
constexpr const char* kOutside = "is outside the world's bounds";

void add_listed_views(const Options& options, const std::vector<io::ListedPose>& poses,
                      const GroundTruth& truth, Plan& plan) {
  for (const io::ListedPose& listed : poses) {
    const auto key = truth.lattice().key(listed.pose.position);
    if (!key || !truth.bounds().contains(*key)) refuse_pose(options, listed, kOutside);
    if (truth.holds_surface(*key))
      refuse_pose(
          options, listed,
          "is in a wall: a surface passes through its voxel; move it, or give a smaller --resolution");
    if (truth.at(*key) != sim::Truth::kFree)
      refuse_pose(options, listed, "cannot be reached from the start: it is in a solid, or in a closed room");
    for (std::size_t i = 0; i < plan.robots.size(); ++i) plan.views.push_back({i, listed.pose});
  }
}

void add_sweep(const Options& options, const GroundTruth& truth, const Eigen::Vector3d& around, Plan& plan) {
  std::vector<planner::Robot> robots;
  for (const RobotDescription& robot : plan.robots) robots.push_back(robot.robot);
  const auto starts = sim::find_starts(truth, around, robots);
  std::vector<View> after;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const std::string& name = robots[i].name;
    const std::optional<Pose>& pose = starts[i];
    if (!pose) {
      plan.starts += row(name, "does not fit within 15 m of the start: left out");
      continue;
    }
    plan.starts += row(name, "starts at " + to_text(Eigen::Vector3f(pose->position.cast<float>())) + " m");
    const auto bubble = sim::start_bubble(truth, robots[i], *pose);
    plan.bubble.insert(plan.bubble.end(), bubble.begin(), bubble.end());
    for (const Pose& view : planner::look_around(robots[i].view, *pose)) plan.views.push_back({i, view});
    for (const Pose& view : sim::sweep(truth, robots[i], *pose, options.sweep)) after.push_back({i, view});
  }
  if (plan.views.empty())
    throw BadInput(options.source.world + ": no robot fits within 15 m of the start; give another --start");
  plan.views.insert(plan.views.end(), after.begin(), after.end());
}

// @throws Interrupted
void scan(const SourcedWorld& sourced, const GroundTruth& truth, const Plan& plan, const Options& options,
          Mapping& mapping) {
  const InterruptNote note;
  const ProgressLine progress;
  constexpr double kBetweenLooks = 0.5;  // [s]
  std::optional<Stopwatch> last_look;
  std::string mapped;
  const auto report = [&](std::size_t done) {
    if (progress.visible()) {
      if (!last_look || last_look->seconds() >= kBetweenLooks) {
        mapped = percent(sim::measure(truth, mapping.grid()).of_observable());
        last_look.emplace();
      }
      progress.show("scan " + std::to_string(done) + " of " + std::to_string(plan.views.size()) +
                    ", mapped " + mapped + " of the observable space");
    }
    return !InterruptNote::taken();
  };
  mapping.mark_free(plan.bubble);
  sim::scan_world(sim::Surface(sourced.world.mesh), plan.robots, plan.views,
                  {options.errors, options.seed.value_or(kSeed)}, mapping, report);
  if (InterruptNote::taken()) throw Interrupted();
}

void print_summary(const Options& options, const SourcedWorld& sourced, const GroundTruth& truth,
                   const Plan& plan, const Mapping& mapping, double seconds) {
  const auto voxels = mapping.grid().count();
  const sim::Coverage coverage = sim::measure(truth, mapping.grid());
  std::string out = row("map", options.output) + row("world", sourced.world.name);
  if (sourced.kind == WorldKind::kBuiltIn) out += row("seed", std::to_string(sourced.seed));
  if (options.source.ground)
    out += row("ground", "shifted by " + rounded(sourced.ground_shift) + " m along z");
  out += row("resolution", to_text(mapping.grid().resolution()) + " m") + plan.starts +
         row("scans", std::to_string(plan.views.size())) +
         row("free", std::to_string(voxels[1]) + " voxels") +
         row("occupied", std::to_string(voxels[2]) + " voxels") +
         row("unknown", std::to_string(coverage.bounding - coverage.known_bounding) + " voxels") +
         row("mapped", percent(coverage.of_observable(), 2) + " of the observable space, " +
                           percent(coverage.of_bounding(), 2) + " of the world's box") +
         row("right", accuracy_text(sim::measure_accuracy(truth, mapping.grid()))) +
         row("time", fixed(seconds, 2) + " s");
  std::cout << out;
}

void run(Options& options) {
  const Stopwatch watch;
  WorldSource& source = options.source;
  const auto& [sigma, dropout, stray, growth] = options.errors;
  const bool errs = sigma > 0.0 || dropout > 0.0 || stray > 0.0 || growth > 0.0;
  if (options.seed && !errs && !is_built_in_world(source.world))
    throw BadInput("--seed: " + source.world +
                   " is not a built-in world, and sensors make no errors; leave the option out");
  if (is_built_in_world(source.world)) source.seed = options.seed.value_or(kSeed);
  std::vector<std::string> inputs{source.world, options.poses};
  for (const RobotWord& robot : options.scanners.robots) inputs.push_back(robot.word);
  check_output(options.output, {".bt", ".ot"}, inputs);
  std::vector<io::ListedPose> poses;
  if (!options.poses.empty()) poses = io::read_pose_list(options.poses);

  std::optional<WorkingLine> working(std::in_place, "preparing " + source.world);
  SourcedWorld sourced = make_world(source);
  for (io::ListedPose& listed : poses) listed.pose.position.z() += sourced.ground_shift;
  // Without a start, what can be seen begins where the first sensor is.
  if (!sourced.world.start && !poses.empty()) {
    if (!sourced.world.bounds.contains(poses.front().pose.position))
      refuse_pose(options, poses.front(), kOutside);
    sourced.world.start = poses.front().pose.position;
  }
  if (!sourced.world.start)
    throw BadInput(sourced.world.name + ": no start is known; give --start in free space");
  const GroundTruth truth(
      sourced.world, source.resolution,
      sim::free_start(sourced.world, source.resolution, sourced.kind != WorldKind::kMesh));
  Plan plan;
  for (const RobotWord& robot : options.scanners.robots) {
    plan.robots.push_back(describe(robot));
    check(robot, plan.robots.back().robot, Lattice(source.resolution));
  }
  if (!options.poses.empty())
    add_listed_views(options, poses, truth, plan);
  else
    add_sweep(options, truth, sim::free_start(sourced.world, source.resolution, false), plan);
  Mapping mapping(
      {.resolution = source.resolution, .bounds = truth.bounds(), .sensor_model = options.sensor_model});
  working.reset();
  scan(sourced, truth, plan, options, mapping);
  if (!mapping.grid().known_bounds())
    throw BadInput(source.world + ": the scans make no voxel free or occupied; nothing was written");
  mapping.write(options.output);
  print_summary(options, sourced, truth, plan, mapping, watch.seconds());
}

}  // namespace

void add_scan_command(CLI::App& app) {
  Command command(app, "scan", "Map a world with simulated sensors");
  const auto options = std::make_shared<Options>();
  command.add("WORLD", options->source.world, "", "Built-in world (see frontlux world), mesh or OctoMap file")
      .required();
  command.add("-o,--output", options->output, "FILE", "Map to write, .bt or .ot").required();
  command.group("Scans");
  Option sweep = command.add("--sweep", options->sweep, "METRES",
                             "Scan from poses all over the free space, with this spacing", kAboveZero);
  command
      .add("--poses", options->poses, "FILE",
           "Scan from these sensor poses: lines x,y,z,yaw [m, rad], before the --ground shift")
      .excludes(sweep);
  command.add(
      "--robot", options->scanners, "both|ugv|uav|FILE",
      "Sensors of the ugv (lidar, 6 m), the uav (depth camera, 10 m), or a robot's .json file [both]");
  command.add("--noise", options->errors.sigma, "METRES", "Standard deviation of a range", kRangeNoise);
  command.add("--noise-growth", options->errors.growth, "K",
              "Further standard deviation of a range: this times its square [1/m]", kNoiseGrowth);
  command.add("--dropout", options->errors.dropout, "P", "Probability that a ray gives no measurement",
              kProbability);
  command.add("--stray", options->errors.stray, "P",
              "Probability that a ray returns from nowhere, as from dust, before any surface", kProbability);
  add_sensor_model_option(command, options->sensor_model);
  command.add("--seed", options->seed, "N", "Random seed (layout of a built-in world, noise) [1]", kSeeds);
  add_world_options(command, options->source, "off");
  command.examples(R"(Examples:
  frontlux scan storage --seed 4 -o storage.bt
  frontlux scan house.ply --start 1,2,0.5 --ground auto --resolution 0.1 --sweep 1.5 -o house.ot
A sweep begins at the robots' starts, near the world's start or --start; the space around them counts
as free. The map is written when all scans are done.)");
  command.run(
      [options] { work_on(options->source.world, "give a coarser --resolution", [&] { run(*options); }); });
}

}  // namespace frontlux::app
