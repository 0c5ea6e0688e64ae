#include "commands/render_command.hpp"

#include "bad_input.hpp"
#include "caster_option.hpp"
#include "cell_table.hpp"
#include "draw/png_file.hpp"
#include "draw/view_picture.hpp"
#include "frontier_count.hpp"
#include "map_file.hpp"
#include "text.hpp"

#include <frontlux/planner/frontier_set.hpp>
#include <frontlux/planner/goal_selection.hpp>

#include <CLI/CLI.hpp>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace frontlux::app {
namespace {

using planner::Goal;
using planner::GoalRule;
using planner::GoalSelection;
using planner::GoalState;
using planner::Method;
using planner::Motion;
using planner::RenderedCell;
using planner::TeamMember;

constexpr std::uint64_t kMaxSurfaceBricks = std::uint64_t{1} << 22;  // of large free blocks, for frontiers

struct Options {
  std::string map, robot, at, output;
  std::string samples, floor, seed = "1";  // as written; empty if not given
  std::string mode = "default", show = "best";
  CasterKind caster = CasterKind::kFast;
  bool any_ground = false;
};

class Stopwatch {
 public:
  /// [ms] since it was made
  [[nodiscard]] double read() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::uint64_t parse_count(const char* name, const std::string& text, std::uint64_t low, std::uint64_t high) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || end != text.data() + text.size() || count < low || count > high)
    throw BadInput(std::string(name) + ": '" + text + "' is not a whole number from " + std::to_string(low) +
                   " to " + std::to_string(high));
  return count;
}

// What would fail in the end fails before the work.
std::string check_output(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending != ".png" && ending != ".ply" && ending != ".csv")
    throw BadInput("--output: " + file.string() +
                   " is no name for an image; give one that ends in .png, .ply or .csv");
  std::error_code error;
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, error))
    throw BadInput("--output: there is no folder " + folder.string() + "; make it first");
  if (std::filesystem::is_directory(file, error))
    throw BadInput("--output: " + file.string() + " is a folder; name a file in it");
  return ending;
}

TeamMember make_member(const Options& options) {
  const Method method = options.mode == "paper" ? Method::kPaper : Method::kDefault;
  TeamMember member;
  member.robot = options.robot == "ugv" ? planner::ugv() : planner::uav(method);
  if (!options.floor.empty()) {
    if (member.robot.travel.motion == Motion::kPlane)
      throw BadInput("--floor: a ugv's plane is that of --at; leave the option out");
    member.robot.travel.floor = parse_number("--floor", options.floor);
  }
  if (options.any_ground) member.robot.travel.require_ground = false;
  member.options = planner::goal_options(member.robot, method);
  member.options.prune = false;  // the picture shows them all
  ViewQualityOptions& rendering = member.options.rendering;
  if (!options.samples.empty())
    rendering.samples =
        options.samples == "all"
            ? ViewQualityOptions::kAll
            : static_cast<int>(parse_count("--samples", options.samples, 1, ViewQualityOptions::kAll));
  rendering.seed = parse_count("--seed", options.seed, 0, UINT64_MAX);
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
  int best_squared = 0;
  const int reach_z = motion == Motion::kPlane ? 0 : kReach;
  for (int x = -kReach; x <= kReach; ++x)
    for (int y = -kReach; y <= kReach; ++y)
      for (int z = -reach_z; z <= reach_z; ++z) {
        const int squared = x * x + y * y + z * z;
        if (best && squared >= best_squared) continue;
        const int key_x = at.x + x, key_y = at.y + y, key_z = at.z + z;
        if (((key_x | key_y | key_z) & ~0xFFFF) != 0) continue;
        const VoxelKey key =
            corridor.cell_of({static_cast<std::uint16_t>(key_x), static_cast<std::uint16_t>(key_y),
                              static_cast<std::uint16_t>(key_z)});
        if (!corridor.passable(key)) continue;
        best = key;
        best_squared = squared;
      }
  if (!best) return "; it fits nowhere near, so give another place";
  const auto along = [&](std::uint16_t k) { return rounded(lattice.center(k)); };
  return "; it fits at " + along(best->x) + "," + along(best->y) + "," + along(best->z);
}

void check_goal(const View& view, const GoalSelection& selection, const Options& options,
                const Lattice& lattice) {
  const Goal& goal = view.goal();
  if (goal.state == GoalState::kNoFrontiers)
    throw BadInput(options.map +
                   ": nothing is left to see: no unknown voxel within the map's bounds shares a face with a "
                   "free one");
  if (goal.state != GoalState::kNoCorridor) return;
  const VoxelKey at{lattice.key(view.pose.position.x()).value(), lattice.key(view.pose.position.y()).value(),
                    lattice.key(view.pose.position.z()).value()};
  const planner::TravelCorridor& corridor = selection.corridor(0);
  throw BadInput("--at: " + options.at + ": the " + options.robot + " " +
                 std::string(describe(corridor.state())) +
                 (corridor.state() == planner::CorridorState::kWithoutGround ? " (see --any-ground)" : "") +
                 nearest_fit(corridor, lattice, at, view.member.robot.travel.motion));
}

View look(const MapFile& map, const VoxelGrid& grid, const Options& options, TeamMember member) {
  View view;
  const Eigen::Vector3f at = parse_vector("--at", options.at);
  const Lattice& lattice = grid.lattice();
  if (!lattice.key(at))
    throw BadInput("--at: " + options.at + " lies outside the map's key range; give a place in the map");
  const auto bounds = grid.known_bounds();
  if (!bounds) throw BadInput(options.map + ": every voxel is unknown; there is nowhere to go");
  if (!count_frontiers(grid, *bounds, kMaxSurfaceBricks))
    throw BadInput(options.map + ": its large free blocks have too wide a surface to look for frontiers");
  view.pose.position = at.cast<double>();
  view.member = std::move(member);

  const planner::FrontierSet frontiers(grid, *bounds);
  const Stopwatch building;
  const auto caster =
      std::visit([&](const auto& tree) { return make_ray_caster(options.caster, grid, *tree); }, map.tree);
  view.caster_ms = building.read();
  GoalSelection selection({view.member}, lattice, *bounds);
  const Stopwatch selecting;
  view.goals = selection.select(*caster, grid, frontiers.keys(), {&view.pose, 1});
  view.selection_ms = selecting.read();
  check_goal(view, selection, options, lattice);
  view.corridor = selection.corridor(0).cells().size();
  view.targets.assign(selection.targets(0).begin(), selection.targets(0).end());
  view.cells = selection.rendered_cells(0);
  if (view.member.options.rule != GoalRule::kViewQuality) {
    // The rule renders no image by itself; the picture shows what eq. 1 says all the same.
    TeamMember rendered = view.member;
    rendered.options.rule = GoalRule::kViewQuality;
    rendered.options.rendering.estimator = ViewQualityOptions::Estimator::kUnbiased;  // clusters count, too
    GoalSelection image({rendered}, lattice, *bounds);
    static_cast<void>(image.select(*caster, grid, frontiers.keys(), {&view.pose, 1}));
    view.cells = image.rendered_cells(0);
  }
  return view;
}

int cell_edge(const TeamMember& member, double resolution) {
  int edge = std::max(1, static_cast<int>(std::lround(member.options.viewpoint_spacing / resolution)));
  for (const double node = member.robot.travel.node_edge; edge * resolution < node * (1.0 - 1e-9);) edge *= 2;
  return edge;
}

std::string number(double value, int digits) {
  std::array<char, 64> buffer{};
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, digits)
          .ptr;
  return {buffer.data(), end};
}

std::string place_of(const planner::Pose& pose) {
  return number(pose.position.x(), 2) + ", " + number(pose.position.y(), 2) + ", " +
         number(pose.position.z(), 2) + " m, yaw " + number(pose.yaw * 180.0 / std::numbers::pi, 1) +
         " degrees";
}

std::string gain_of(const Goal& goal) {
  return number(goal.gain, 1) + (goal.standard_error > 0.0 ? " +- " + number(goal.standard_error, 1) : "") +
         " frontiers";
}

void write_picture(const VoxelGrid& grid, const Options& options, const View& view) {
  std::vector<RenderedCell> cells = view.cells;
  const int edge = cell_edge(view.member, grid.resolution());
  if (options.show == "layer") {
    const int layer = grid.lattice().key(view.pose.position.z()).value();
    std::erase_if(cells, [&](const RenderedCell& cell) { return cell.cell.z / edge != layer / edge; });
  }
  const Goal& goal = view.goal();
  const std::string name = std::filesystem::path(options.map).filename().string();
  std::vector<std::string> title = {view.member.robot.name + " in " + name + ", voxels of " +
                                    rounded(grid.resolution()) + " m"};
  title.push_back(goal.pose ? "goal " + place_of(*goal.pose) : std::string(goal.reason));
  if (goal.pose)
    title.push_back("gain " + gain_of(goal) + ", " + number(goal.distance, 1) + " m away, view quality " +
                    number(goal.quality, 1));
  try {
    write_png(options.output, draw_view({grid, view.member.robot, view.pose, cells, edge, view.targets, goal,
                                         std::move(title)}));
  } catch (const std::invalid_argument& error) {
    throw BadInput("--output: " + std::string(error.what()));
  }
}

void print(const Options& options, const View& view, double write_ms) {
  const Goal& goal = view.goal();
  std::string out = row("map", options.map) +
                    row("corridor", std::to_string(view.corridor) + " cells, of which " +
                                        std::to_string(view.cells.size()) + " are rendered") +
                    row("frontiers", std::to_string(view.goals.frontiers) + ", of which the " +
                                         options.robot + " takes " + std::to_string(goal.assigned)) +
                    row("goal", goal.pose ? place_of(*goal.pose) : "none");
  if (goal.pose)
    out += row("gain", gain_of(goal)) + row("distance", number(goal.distance, 2) + " m") +
           row("quality", number(goal.quality, 2));
  out += row("reason", goal.reason) +
         row("time", number(view.selection_ms, 1) + " ms for corridor, distribution and goal, with " +
                         std::to_string(view.goals.rays) + " rays; " + number(view.caster_ms, 1) +
                         " ms to build the caster, " + number(write_ms, 1) + " ms to write") +
         row("written", options.output);
  std::cout << out;
}

void render(const Options& options) {
  const std::string ending = check_output(options.output);
  TeamMember member = make_member(options);
  const MapFile map = read_map_file(options.map);
  try {
    const VoxelGrid grid = make_voxel_grid(map);
    const View view = look(map, grid, options, std::move(member));
    const Stopwatch writing;
    if (ending == ".csv")
      write_csv(options.output, grid.lattice(), view.cells);
    else if (ending == ".ply")
      write_ply(options.output, grid.lattice(), view.cells);
    else
      write_picture(grid, options, view);
    print(options, view, writing.read());
  } catch (const BadInput&) {
    throw;
  } catch (const std::invalid_argument& error) {  // a robot or range that does not suit this map
    throw BadInput(options.map + ": " + error.what());
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  } catch (const std::bad_alloc&) {
    throw BadInput(options.map + ": its travel corridor does not fit into this machine's memory");
  }
}

}  // namespace

void add_render_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("render", "Show from where a robot would see most of what is unknown");
  const auto options = std::make_shared<Options>();
  command->add_option("MAP", options->map, "OctoMap file, .bt or .ot")->required();
  command->add_option("--robot", options->robot, "ugv or uav")
      ->required()
      ->check(CLI::IsMember({"ugv", "uav"}));
  command->add_option("--at", options->at, "Where its sensor is [m]")->required()->type_name("X,Y,Z");
  command->add_option("-o,--output", options->output, "File to write, .png, .csv or .ply")
      ->required()
      ->type_name("FILE");
  command->add_option("--samples", options->samples, "Frontiers drawn for each cell, or all; 64 if not given")
      ->type_name("N");
  command->add_option("--mode", options->mode, "As the paper has it, or what works best")
      ->check(CLI::IsMember({"default", "paper"}))
      ->capture_default_str();
  add_caster_option(*command, options->caster, "What casts the rays");
  command->add_option("--seed", options->seed, "Of the draws")->type_name("N")->capture_default_str();
  command
      ->add_option("--show", options->show,
                   "In a picture, the best cell of each column or those of the robot's layer")
      ->check(CLI::IsMember({"best", "layer"}))
      ->capture_default_str();
  command
      ->add_option("--floor", options->floor,
                   "Height of the floor, above which a uav keeps [m]; 0 if not given")
      ->type_name("M");
  command->add_flag("--any-ground", options->any_ground, "Let a ugv drive where no floor is known");
  command->footer(
      "Examples:\n"
      "  frontlux render hall.bt --robot ugv --at 0,0,0.75 -o hall.png\n"
      "  frontlux render hall.bt --robot uav --at 0,0,1.65 --samples all -o hall.csv\n"
      "A ugv's sensor is 0.75 m above the floor it drives on, a uav's at least 1.2 m. Yaws are in radians "
      "in\n"
      "files, counter-clockwise from x.");
  command->callback([options] { render(*options); });
}

}  // namespace frontlux::app
