#include "bad_input.hpp"
#include "cell_table.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "commands/output_file.hpp"
#include "commands/robot_option.hpp"
#include "draw/view_picture.hpp"
#include "map_file.hpp"
#include "terminal.hpp"
#include "text.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/planner/goal_selection.hpp>
#include <frontlux/stopwatch.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::app {
namespace {

using planner::Goal, planner::GoalRule, planner::GoalSelection, planner::GoalState, planner::Method,
    planner::Motion, planner::RenderedCell, planner::TeamMember;

enum class Shown { kBest, kLayer };

// "all", or a number of them.
struct Samples {
  int number = ViewQualityOptions::kAll;
};
void read(std::string_view word, Samples& samples) {
  if (word == "all") return;
  try {
    read(word, samples.number, Range<int>{1, ViewQualityOptions::kAll});
  } catch (const BadInput& error) {
    throw BadInput(error.what() + std::string(", or all"));
  }
}

struct Options {
  std::string map, output;
  RobotWord robot;
  Eigen::Vector3f at = Eigen::Vector3f::Zero();
  std::optional<Eigen::AlignedBox3d> bounds;
  std::optional<double> floor;
  bool any_ground = false;
  Method mode = Method::kDefault;
  std::optional<Samples> samples;
  std::optional<std::uint64_t> seed;
  CasterKind caster = CasterKind::kFast;
  std::optional<Shown> show;
};

// Options that would change nothing beside the others.
void check_options(const Options& options) {
  const auto ending = std::filesystem::path(options.output).extension();
  if (options.show && (ending == ".csv" || ending == ".ply"))
    throw BadInput("--show: a table holds all cells; leave the option out, or write a .png");
}

// The same for those of the draws, of which there may be none.
void check_draws(const Options& options, const TeamMember& member) {
  const bool exact = member.options.rendering.renderer == ViewQualityOptions::Renderer::kExact;
  if (exact && options.samples)
    throw BadInput("--samples: of the " + member.robot.name +
                   " all frontiers are counted, not drawn; leave the option out, or give --mode paper");
  if (options.seed && (exact || member.options.rendering.samples == ViewQualityOptions::kAll))
    throw BadInput("--seed: all frontiers are counted, not drawn; leave the option out");
}

TeamMember make_member(const Options& options) {
  TeamMember member;
  member.robot = describe(options.robot, options.mode).robot;
  planner::TravelOptions& travel = member.robot.travel;
  if (options.floor && travel.drives())
    throw BadInput("--floor: the " + member.robot.name + " stays on the ground; leave the option out");
  if (options.any_ground && travel.motion != Motion::kPlane)
    throw BadInput("--any-ground: the " + member.robot.name +
                   " does not drive on a plane; leave the option out");
  travel.floor = options.floor.value_or(travel.floor);
  if (options.any_ground) travel.require_ground = false;
  member.options = planner::goal_options(member.robot, options.mode);
  member.options.prune = false;  // the picture shows them all
  if (options.samples) member.options.rendering.samples = options.samples->number;
  member.options.rendering.seed = options.seed.value_or(1);
  check_draws(options, member);
  return member;
}

// What the drawing and the tables are made of.
struct View {
  TeamMember member;
  planner::Pose pose;
  planner::TeamGoals goals;
  std::vector<RenderedCell> cells;
  std::vector<VoxelKey> targets;
  std::size_t corridor = 0;
  double caster_ms = 0.0, selection_ms = 0.0;

  [[nodiscard]] const Goal& goal() const { return goals.goals.front(); }
};

// Where the robot would fit, as the end of a message.
std::string nearest_fit(const planner::TravelCorridor& corridor, const Lattice& lattice, const VoxelKey& at,
                        Motion motion) {
  constexpr int kReach = 48;  // [voxels]
  std::optional<VoxelKey> best;
  double best_squared = 0.0;
  for_each_key(grown({at, at}, kReach, kReach, motion == Motion::kPlane ? 0 : kReach),
               [&](const VoxelKey& key) {
                 const double squared = (lattice.exact_center(key) - lattice.exact_center(at)).squaredNorm();
                 if (best && squared >= best_squared) return;
                 const VoxelKey cell = corridor.cell_of(key);
                 if (!corridor.passable(cell)) return;
                 best = cell;
                 best_squared = squared;
               });
  if (!best) return "; it fits nowhere near, so give another place";
  const Eigen::Vector3d center = lattice.exact_center(*best);
  return "; it fits at " + rounded(center.x()) + "," + rounded(center.y()) + "," + rounded(center.z());
}

void check_goal(const View& view, const GoalSelection& selection, const Options& options,
                const Lattice& lattice) {
  const Goal& goal = view.goal();
  if (goal.state == GoalState::kNoFrontiers)
    throw BadInput(
        options.map +
        ": the map has no frontiers: no unknown voxel within its bounds shares a face with a free one");
  if (goal.state != GoalState::kNoCorridor) return;
  const planner::TravelCorridor& corridor = selection.corridor(0);
  const VoxelKey at = lattice.key(view.pose.position).value();
  throw BadInput("--at: at " + to_text(options.at) + " the " + view.member.robot.name + " " +
                 std::string(describe(corridor.state())) +
                 (corridor.state() == planner::CorridorState::kWithoutGround &&
                          view.member.robot.travel.motion == Motion::kPlane
                      ? " (see --any-ground)"
                      : "") +
                 nearest_fit(corridor, lattice, at, view.member.robot.travel.motion));
}

View look(const MapFile& map, const VoxelGrid& grid, const Options& options, TeamMember member) {
  View view;
  const Lattice& lattice = grid.lattice();
  if (!lattice.key(options.at))
    throw BadInput("--at: " + to_text(options.at) + " lies outside the map's key range, which ends " +
                   rounded(Lattice::kOrigin * lattice.resolution()) +
                   " m from its origin; give a place in the map");
  const KeyBox bounds = robot_space(map, grid, options.bounds, member.robot.travel.motion);
  const auto frontiers = find_frontiers(map, grid, bounds);
  if (!frontiers)
    throw BadInput(options.map +
                   ": the surface of its large free blocks is too large to look for frontiers; choose a "
                   "part of it with --bounds");
  view.pose.position = options.at.cast<double>();
  view.member = std::move(member);

  const Stopwatch building;
  const auto caster = make_caster(map, grid, options.caster);
  view.caster_ms = building.milliseconds();
  GoalSelection selection({view.member}, lattice, bounds);
  const Stopwatch selecting;
  view.goals = selection.select(*caster, {grid}, frontiers->keys(), {&view.pose, 1});
  view.selection_ms = selecting.milliseconds();
  check_goal(view, selection, options, lattice);
  view.corridor = selection.corridor(0).cells().size();
  view.targets.assign(selection.targets(0).begin(), selection.targets(0).end());
  view.cells = selection.rendered_cells(0);
  if (view.member.options.rule != GoalRule::kViewQuality) {
    // The rule renders no image by itself; the picture shows eq. 1 nevertheless.
    TeamMember rendered = view.member;
    rendered.options.rule = GoalRule::kViewQuality;
    rendered.options.rendering.estimator = ViewQualityOptions::Estimator::kUnbiased;  // clusters count, too
    GoalSelection image({rendered}, lattice, bounds);
    static_cast<void>(image.select(*caster, {grid}, frontiers->keys(), {&view.pose, 1}));
    view.cells = image.rendered_cells(0);
  }
  return view;
}

int cell_edge(const TeamMember& member, double resolution) {
  int edge = std::max(1, static_cast<int>(std::lround(member.options.viewpoint_spacing / resolution)));
  for (const double node = member.robot.travel.node_edge; edge * resolution < node * (1.0 - 1e-9);) edge *= 2;
  return edge;
}

std::string place_of(const planner::Pose& pose) {
  return fixed(pose.position.x(), 2) + ", " + fixed(pose.position.y(), 2) + ", " +
         fixed(pose.position.z(), 2) + " m, yaw " + fixed(pose.yaw, 2) + " rad";
}

std::string gain_of(const Goal& goal) {
  return fixed(goal.gain, 1) + (goal.standard_error > 0.0 ? " +- " + fixed(goal.standard_error, 1) : "") +
         " frontiers";
}

void write_picture(const VoxelGrid& grid, const Options& options, const View& view) {
  std::vector<RenderedCell> cells = view.cells;
  const int edge = cell_edge(view.member, grid.resolution());
  if (options.show == Shown::kLayer) {
    const int layer = grid.lattice().key(view.pose.position.z()).value();
    std::erase_if(cells, [&](const RenderedCell& cell) { return cell.cell.z / edge != layer / edge; });
  }
  const Goal& goal = view.goal();
  const std::string name = std::filesystem::path(options.map).filename().string();
  std::vector<std::string> title;
  title.push_back(view.member.robot.name + " in " + name + ", voxels of " + rounded(grid.resolution()) +
                  " m");
  title.push_back(goal.pose ? "goal " + place_of(*goal.pose) : std::string(goal.reason));
  if (goal.pose)
    title.push_back("gain " + gain_of(goal) + ", " + fixed(goal.distance, 1) + " m away, view quality " +
                    fixed(goal.quality, 1));
  try {
    draw_view({grid, view.member.robot, view.pose, cells, edge, view.targets, goal, std::move(title)})
        .write(options.output);
  } catch (const std::invalid_argument& error) {
    throw BadInput("--output: " + std::string(error.what()));
  }
}

void print(const Options& options, const View& view, double write_ms) {
  const Goal& goal = view.goal();
  std::string out =
      row("map", options.map) +
      row("corridor", std::to_string(view.corridor) + " cells, " + std::to_string(view.cells.size()) +
                          " of them rendered") +
      row("frontiers", std::to_string(view.goals.frontiers) + ", " + std::to_string(goal.assigned) +
                           " of them assigned to the " + view.member.robot.name) +
      row("goal", goal.pose ? place_of(*goal.pose) : "none");
  if (goal.pose)
    out += row("gain", gain_of(goal)) + row("distance", fixed(goal.distance, 2) + " m") +
           row("quality", fixed(goal.quality, 2));
  out += row("reason", goal.reason) +
         row("time", fixed(view.selection_ms, 1) + " ms for corridor, assignment and goal, with " +
                         std::to_string(view.goals.rays) + " rays; " + fixed(view.caster_ms, 1) +
                         " ms to build the caster, " + fixed(write_ms, 1) + " ms to write") +
         row("written", options.output);
  std::cout << out;
}

void render(const Options& options) {
  check_options(options);
  check_output(options.output, {".png", ".svg", ".pdf", ".ply", ".csv"},
               std::array{options.map, options.robot.word});
  const MapFile map = read_map_file(options.map);
  const VoxelGrid grid = make_grid(map);
  TeamMember member = make_member(options);
  check(options.robot, member.robot, grid.lattice());
  const View view = [&] {
    const WorkingLine working("rendering");
    return look(map, grid, options, std::move(member));
  }();
  const Stopwatch writing;
  const auto ending = std::filesystem::path(options.output).extension();
  if (ending == ".csv")
    write_csv(options.output, grid.lattice(), view.cells);
  else if (ending == ".ply")
    write_ply(options.output, grid.lattice(), view.cells);
  else
    write_picture(grid, options, view);
  print(options, view, writing.milliseconds());
}

}  // namespace

template <>
inline constexpr std::array<Choice<Shown>, 2> kChoices<Shown>{
    {{"best", Shown::kBest}, {"layer", Shown::kLayer}}};

void add_render_command(CLI::App& app) {
  Command command(app, "render", "Show how many frontiers a robot would see from each place it can reach");
  const auto options = std::make_shared<Options>();
  command.add("MAP", options->map, "", "OctoMap file, .bt or .ot").required();
  command
      .add("-o,--output", options->output, "FILE",
           "Picture (.png, .svg, .pdf) or table (.csv, .ply) to write")
      .required();
  command.add("--bounds", options->bounds, "X,Y,Z,X,Y,Z",
              "Part of the map to look at: its lowest and its highest corner [all]");
  command.add("--show", options->show, "Picture: the best cell of each column, or the robot's layer [best]");
  command.group("Robot");
  command
      .add("--robot", options->robot, "ugv|uav|FILE",
           "Ground robot with a lidar, aerial robot with a depth camera, or one described in a .json file")
      .required();
  command.add("--at", options->at, "X,Y,Z", "Position of its sensor").required();
  command.add("--floor", options->floor, "METRES",
              "In space: height of the floor, above which a uav keeps 1.2 m [0]", kAnyNumber);
  command.add_flag("--any-ground", options->any_ground, "On a plane: also drive where no floor is known");
  command.group("Method");
  command.add("--mode", options->mode, "What works best, or as printed in the paper");
  command.add("--samples", options->samples, "N|all",
              "Frontiers drawn for each cell, where they are drawn [by mode]");
  command.add("--seed", options->seed, "N", "Random seed of the draws [1]", kSeeds);
  command.add("--caster", options->caster, "Ray caster");
  command.examples(R"(Examples:
  frontlux render hall.bt --robot ugv --at 0,0,0.75 -o hall.png
  frontlux render hall.bt --robot uav --at 0,0,1.65 --samples all -o hall.csv
The sensor of a ugv is 0.75 m above the floor that it drives on, that of a uav at least 1.2 m. Yaws in
tables are in radians, counter-clockwise from x.)");
  command.run(
      [options] { work_on(options->map, "give a map of a coarser resolution", [&] { render(*options); }); });
}

}  // namespace frontlux::app
