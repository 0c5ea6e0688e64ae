#include "bad_input.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "commands/output_file.hpp"
#include "terminal.hpp"
#include "text.hpp"
#include "world_source.hpp"

#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/mesh_file.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <array>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

namespace frontlux::app {
namespace {

struct Options {
  WorldSource source;
  std::string output;
};

void print_list() {
  std::string out;
  for (const auto& [name, description] : sim::built_in_worlds()) out += row(name, description);
  std::cout << out;
}

// @param seen  [m3] free space that is known to be there
std::string free_volume_text(const sim::World& world, double seen) {
  const auto solid = sim::solid_volume(world.mesh);
  if (!solid) return "not known: the surface is not closed, or its triangles are oriented differently";
  // A surface that faces inwards, towards free space, holds just that.
  const double free = *solid >= 0.0 ? world.bounds.volume() - *solid : -*solid;
  if (free < 0.0) return "not known: solids overlap";
  constexpr double kRounding = 1.1;  // of volumes in voxels
  if (seen > kRounding * free)
    return "not known: more of it can be observed than the surface says; do its triangles face inwards?";
  constexpr double kFilled = 1e-6;  // of the bounds
  if (free <= kFilled * world.bounds.volume())
    return "not known: the surface faces outwards, as that of a solid that fills the bounds";
  return rounded(free) + " m^3, of " + rounded(world.bounds.volume()) + " m^3 within the bounds";
}

std::string start_text(const sim::World& world) {
  if (!world.start) return "none: give --start";
  const auto floor = sim::floor_below(world.mesh, *world.start);
  return to_text(Eigen::Vector3f(world.start->cast<float>())) + " m, " +
         (floor ? "above a floor at z = " + rounded(*floor) + " m" : "with no floor below");
}

struct Observable {
  std::string text;
  double free = 0.0;  // [m3]
};

Observable find_observable(const SourcedWorld& sourced, double resolution) {
  if (!sourced.world.start) return {"not known: give --start"};
  if (sourced.voxels > kManyVoxels)
    return {"not counted: more than " + rounded(kManyVoxels) + " voxels; give a larger --resolution"};
  try {
    const WorkingLine working("looking for what can be observed");
    const sim::GroundTruth truth(
        sourced.world, resolution,
        sim::free_start(sourced.world, resolution, sourced.kind != WorldKind::kMesh));
    const double voxel = resolution * resolution * resolution;
    return {rounded(static_cast<double>(truth.observable_voxels()) * voxel) +
                " m^3: " + std::to_string(truth.free_voxels()) + " free voxels and " +
                std::to_string(truth.surface_voxels()) + " on their surface",
            static_cast<double>(truth.free_voxels()) * voxel};
  } catch (const std::exception& error) {
    return {std::string("not known: ") + error.what()};
  }
}

void print_text(const SourcedWorld& sourced, const WorldSource& source) {
  const sim::World& world = sourced.world;
  const Eigen::Vector3d size = world.bounds.sizes();
  const Observable observable = find_observable(sourced, source.resolution);
  const auto axis = [&](const char* label, int i) {
    return row(label, rounded(world.bounds.min()[i]) + " to " + rounded(world.bounds.max()[i]) + " m");
  };
  std::string out = row("world", world.name);
  if (sourced.kind == WorldKind::kBuiltIn) out += row("seed", std::to_string(sourced.seed));
  out += row("size", rounded(size.x()) + " x " + rounded(size.y()) + " x " + rounded(size.z()) + " m, " +
                         fixed(sourced.voxels, 0) + " voxels of " + rounded(source.resolution) + " m") +
         axis("bounds x", 0) + axis("       y", 1) + axis("       z", 2) +
         row("triangles", std::to_string(world.mesh.triangles.size())) +
         row("surface", rounded(sim::surface_area(world.mesh)) + " m^2") +
         row("free", free_volume_text(world, observable.free)) + row("start", start_text(world)) +
         row("observable", observable.text);
  if (source.ground) out += row("ground", "shifted by " + rounded(sourced.ground_shift) + " m along z");
  std::cout << out;
}

}  // namespace

void add_world_command(CLI::App& app) {
  Command command(app, "world", "Measure a world to explore, or write it as a mesh");
  const auto options = std::make_shared<Options>();
  WorldSource& source = options->source;
  const Option world =
      command.add("WORLD", source.world, "",
                  "Built-in world, mesh (.ply, .obj, .stl, .dae, .gltf, .glb) or OctoMap file (.bt, .ot)\n"
                  "[list the built-in worlds]");
  command.add("-o,--output", options->output, "FILE.ply", "Write the world's surface to this file");
  command.add("--seed", source.seed, "N", "Layout of a built-in world [1]", kSeeds);
  add_world_options(command, source, "off");
  command.examples(R"(Example:
  frontlux world factory --seed 7 -o factory.ply
prints the measures of the seventh factory and writes it as a mesh.)");
  command.run([options, world] {
    const bool writes = !options->output.empty();
    if (!world.given() && writes) throw BadInput("--output: give the WORLD that is to be written");
    if (!world.given() && options->source.seed)
      throw BadInput("--seed: give the WORLD of which it is the layout");
    if (!world.given()) return print_list();
    if (writes) check_output(options->output, {".ply"}, std::array{options->source.world});
    const SourcedWorld sourced = make_world(options->source);
    if (writes) {
      try {
        sim::write_ply(options->output, sourced.world.mesh);
      } catch (const std::runtime_error& error) {
        throw BadInput(std::string("--output: ") + error.what());
      }
    }
    print_text(sourced, options->source);
  });
}

}  // namespace frontlux::app
