#include "world_source.hpp"

#include "bad_input.hpp"
#include "map_file.hpp"
#include "text.hpp"

#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground.hpp>
#include <frontlux/sim/map_world.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace frontlux::app {
namespace {

constexpr double kMostVoxels = 0x1p31;

WorldKind kind_of(const std::string& name) {
  if (is_built_in_world(name)) return WorldKind::kBuiltIn;
  const auto ending = std::filesystem::path(name).extension();
  if (ending == ".bt" || ending == ".ot") return WorldKind::kMap;
  if (ending.empty() && !std::filesystem::exists(name)) {
    std::string names;
    for (const auto& world : sim::built_in_worlds())
      names.append(names.empty() ? "" : ", ").append(world.name);
    throw BadInput("'" + name + "' is neither a file nor a built-in world; those are " + names);
  }
  return WorldKind::kMesh;
}

void check_options(const WorldSource& source, WorldKind kind) {
  const auto only_for = [&](bool given, WorldKind right, const char* option, const char* what) {
    if (given && kind != right)
      throw BadInput(std::string(option) + " is for " + what + ", and " + source.world + " is none");
  };
  only_for(source.seed.has_value(), WorldKind::kBuiltIn, "--seed", "built-in worlds");
  only_for(source.scale.has_value(), WorldKind::kMesh, "--scale", "mesh files");
  only_for(source.up.has_value(), WorldKind::kMesh, "--up", "mesh files");
}

sim::MeshOptions mesh_options(const WorldSource& source) {
  sim::MeshOptions options;
  if (source.scale) options.scale = parse_number("--scale", *source.scale);
  if (options.scale <= 0.0) throw BadInput("--scale: " + *source.scale + " is not positive");
  if (!source.up) return options;
  if (*source.up != "x" && *source.up != "y" && *source.up != "z")
    throw BadInput("--up: '" + *source.up + "' is not x, y or z");
  options.up = static_cast<sim::UpAxis>((*source.up)[0] - 'x');
  return options;
}

sim::World make_map_world(const std::string& file) {
  const MapFile map = read_map_file(file);
  try {
    sim::World world = sim::make_map_world(make_voxel_grid(map));
    world.name = map.path.filename().string();
    return world;
  } catch (const std::runtime_error& error) {
    throw BadInput(file + ": " + error.what());
  }
}

// What a map of the world would hold; refused before anybody tries.
double count_voxels(const WorldSource& source, const sim::World& world, WorldKind kind) {
  const double voxels = sim::voxel_count(world.bounds, source.resolution);
  if (voxels <= kManyVoxels) return voxels;
  const Eigen::Vector3d size = world.bounds.sizes();
  const std::string what = source.world + ": " + rounded(size.x()) + " x " + rounded(size.y()) + " x " +
                           rounded(size.z()) + " m are " + rounded(voxels) + " voxels of " +
                           rounded(source.resolution) + " m";
  const std::string advice =
      kind == WorldKind::kMesh
          ? "give a larger --resolution, or --scale (0.001 if the file is in millimetres)"
          : "give a larger --resolution";
  if (voxels > kMostVoxels) throw BadInput(what + ", too many to map; " + advice);
  std::cerr << "frontlux: warning: " << what << ", which may take much memory; " << advice << '\n';
  return voxels;
}

void put_start(const std::string& text, sim::World& world) {
  const Eigen::Vector3f start = parse_vector("--start", text);
  world.start = start.cast<double>();
  if (!world.bounds.contains(*world.start))
    throw BadInput("--start: " + to_text(start) + " is outside of the world, which goes from " +
                   to_text(Eigen::Vector3f(world.bounds.min().cast<float>())) + " to " +
                   to_text(Eigen::Vector3f(world.bounds.max().cast<float>())));
}

double align_ground(const WorldSource& source, sim::World& world) {
  std::optional<double> ground;
  if (*source.ground != "auto") ground = parse_number("--ground", *source.ground);
  if (!ground && !world.start)
    throw BadInput("--ground auto looks for the floor below the start: give --start, or the floor's height");
  return sim::align_ground(world, ground, source.resolution);
}

}  // namespace

bool is_built_in_world(const std::string& name) {
  const auto worlds = sim::built_in_worlds();
  return std::any_of(worlds.begin(), worlds.end(), [&](const auto& world) { return world.name == name; });
}

std::uint64_t parse_seed(const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size())
    throw BadInput("--seed: '" + text + "' is not a whole number from 0 to 18446744073709551615");
  return seed;
}

void add_world_options(CLI::App& command, WorldSource& source) {
  command.add_option("--scale", source.scale, "Metres per unit of a mesh file");
  command.add_option("--up", source.up, "Axis of a mesh file that points up: x, y or z");
  command.add_option("--start", source.start,
                     "Where robots start, x,y,z in metres, before the ground is aligned");
  command.add_option(
      "--ground", source.ground,
      "Shift the world so that its floor, at this height or (auto) below the start, lies right "
      "for mapping; the start and all heights shown are those after the shift");
}

SourcedWorld make_world(const WorldSource& source) {
  if (!(source.resolution > 0.0))
    throw BadInput("--resolution: " + rounded(source.resolution) + " is not positive");
  SourcedWorld sourced;
  sourced.kind = kind_of(source.world);
  check_options(source, sourced.kind);
  try {
    if (sourced.kind == WorldKind::kBuiltIn) {
      sourced.seed = source.seed ? parse_seed(*source.seed) : 1;
      sourced.world = sim::make_world(source.world, sourced.seed);
    } else {
      sourced.world = sourced.kind == WorldKind::kMap
                          ? make_map_world(source.world)
                          : sim::read_mesh_world(source.world, mesh_options(source));
    }
    sourced.voxels = count_voxels(source, sourced.world, sourced.kind);
    if (source.start) put_start(*source.start, sourced.world);
    if (source.ground) sourced.ground_shift = align_ground(source, sourced.world);
  } catch (const BadInput&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  }
  return sourced;
}

}  // namespace frontlux::app
