#include "world_source.hpp"

#include "bad_input.hpp"
#include "map_file.hpp"
#include "terminal.hpp"
#include "text.hpp"

#include <frontlux/io/spelling.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/map_world.hpp>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::app {
namespace {

constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 31;
// Of a mesh of up to 100 kB, and in proportion of larger ones: a few bytes may stand for any space.
constexpr std::uint64_t kMostOfSmallMesh = std::uint64_t{1} << 29, kSmallMesh = 100'000;

// By what the mesh holds: its file may refer to others.
std::uint64_t most_voxels(const sim::TriangleMesh& mesh) {
  const std::uint64_t bytes =
      mesh.vertices.size() * sizeof(mesh.vertices[0]) + mesh.triangles.size() * sizeof(mesh.triangles[0]);
  return std::clamp(bytes, kSmallMesh, 4 * kSmallMesh) * (kMostOfSmallMesh / kSmallMesh);
}

double part_outside(const sim::TriangleMesh& mesh, const Eigen::AlignedBox3d& box) {
  constexpr double kRounding = 1e-4;  // [m] of a mesh's floats, which may lie in the box's faces
  const Eigen::Array3d room = Eigen::Array3d::Constant(kRounding);
  const Eigen::AlignedBox3d within(box.min().array() - room, box.max().array() + room);
  const double all = sim::surface_area(mesh);
  return all > 0.0 ? std::clamp(1.0 - sim::surface_area(mesh, within) / all, 0.0, 1.0) : 0.0;
}

WorldKind kind_of(const std::string& name) {
  if (is_built_in_world(name)) return WorldKind::kBuiltIn;
  std::error_code ignored;
  if (std::filesystem::is_directory(name, ignored))
    throw BadInput(quote(name) +
                   " is a directory; name a built-in world (see frontlux world), or a file in it");
  const auto ending = std::filesystem::path(name).extension();
  if (ending == ".bt" || ending == ".ot") return WorldKind::kMap;
  if (ending.empty() && !std::filesystem::exists(name, ignored)) {
    std::vector<std::string> words;
    std::string names;
    for (const auto& world : sim::built_in_worlds()) {
      words.emplace_back(world.name);
      names.append(names.empty() ? "" : ", ").append(world.name);
    }
    const auto meant = io::meant_by(name, words);
    throw BadInput(quote(name) + " is neither a file nor a built-in world" +
                   (meant ? " (did you mean " + *meant + "?)" : "") + "; built-in worlds: " + names);
  }
  return WorldKind::kMesh;
}

void check_options(const WorldSource& source, WorldKind kind) {
  const auto only_for = [&](bool given, WorldKind right, const char* option, const char* what) {
    if (given && kind != right)
      throw BadInput(std::string(option) + ": " + source.world + " is not a " + what +
                     "; leave the option out");
  };
  only_for(source.seed.has_value(), WorldKind::kBuiltIn, "--seed", "built-in world");
  only_for(source.scale.has_value(), WorldKind::kMesh, "--scale", "mesh file");
  only_for(source.up.has_value(), WorldKind::kMesh, "--up", "mesh file");
}

sim::World make_map_world(const std::string& file, const VoxelGrid& grid) {
  try {
    sim::World world = sim::make_map_world(grid);
    world.name = std::filesystem::path(file).filename().string();
    return world;
  } catch (const std::runtime_error& error) {
    throw BadInput(file + ": " + error.what());
  }
}

// What a map of the world would hold; refused before anybody tries.
// @param most  that it may hold
double count_voxels(const WorldSource& source, const Eigen::AlignedBox3d& bounds, WorldKind kind,
                    std::uint64_t most) {
  const double voxels = sim::voxel_count(bounds, source.resolution);
  if (voxels <= kManyVoxels) return voxels;
  const Eigen::Vector3d size = bounds.sizes();
  const std::string what = source.world + ": " + rounded(size.x()) + " x " + rounded(size.y()) + " x " +
                           rounded(size.z()) + " m are " + rounded(voxels) + " voxels of " +
                           rounded(source.resolution) + " m";
  const std::string advice =
      source.box ? "give a larger resolution or a smaller box"
      : kind == WorldKind::kMesh
          ? "give a larger --resolution, or --scale (0.001 if the file is in millimetres)"
          : "give a larger --resolution";
  if (voxels > static_cast<double>(most))
    throw BadInput(what + ", too many: a map holds at most " + std::to_string(most) +
                   (most < kMostVoxels ? " of a mesh so small" : "") + "; " + advice +
                   (most < kMostVoxels ? ", or say in a task what is to be explored (box_m)" : ""));
  const auto bytes = static_cast<std::uint64_t>(voxels), available = available_memory();  // a byte each
  if (bytes > available)
    throw BadInput(what + ", which take " + bytes_text(bytes) + " of memory and more where " +
                   bytes_text(available) + " are left; " + advice);
  ProgressLine().clear();
  warn(what + ", which take " + bytes_text(bytes) + " of memory and more; " + advice);
  return voxels;
}

void put_start(const Eigen::Vector3f& start, const std::string& giver, sim::World& world) {
  world.start = start.cast<double>();
  if (!world.bounds.contains(*world.start))
    throw BadInput(giver + ": " + to_text(start) + " is outside the world, which extends from " +
                   to_text(Eigen::Vector3f(world.bounds.min().cast<float>())) + " to " +
                   to_text(Eigen::Vector3f(world.bounds.max().cast<float>())));
}

}  // namespace

bool is_built_in_world(const std::string& name) {
  const auto worlds = sim::built_in_worlds();
  return std::any_of(worlds.begin(), worlds.end(), [&](const auto& world) { return world.name == name; });
}

void read(std::string_view word, GroundAlignment& ground) {
  ground.align = word != "off";
  ground.height.reset();
  if (!ground.align || word == "auto") return;
  try {
    read(word, ground.height, kAnyNumber);
  } catch (const BadInput&) {
    throw BadInput(quote(word) + " is not auto, off or a height");
  }
}

void add_world_options(Command& command, WorldSource& source, const char* ground_default) {
  command.group("World");
  command.add("--resolution", source.resolution, "METRES", "Edge length of a voxel", kVoxelEdges);
  command.add("--start", source.start, "X,Y,Z",
              "Free point near which robots start, before the --ground shift");
  command.add("--ground", source.ground, "auto|off|Z",
              ("Shift the floor to just below a voxel boundary; auto: the floor below the start [" +
               std::string(ground_default) + "]")
                  .c_str());
  command.group("World", Command::Shown::kInHelpAll);
  command.add("--scale", source.scale, "METRES", "Length of a mesh file's unit [1]", kAboveZero);
  command.add("--up", source.up, "Axis of a mesh file that points up [as the format defines, else z]");
}

SourcedWorld make_world(const WorldSource& source) {
  SourcedWorld sourced;
  sourced.kind = kind_of(source.world);
  check_options(source, sourced.kind);
  work_on(source.world, "give a larger --resolution", [&] {
    // As soon as the bounds are known: all that follows may take long.
    const auto count = [&](const Eigen::AlignedBox3d& bounds, std::uint64_t most = kMostVoxels) {
      sourced.voxels = count_voxels(source, bounds, sourced.kind, most);
    };
    if (source.box) {
      count(*source.box);
      static_cast<void>(sim::voxels_within(*source.box, Lattice(source.resolution)));
    }
    if (sourced.kind == WorldKind::kBuiltIn) {
      sourced.seed = source.seed.value_or(1);
      sourced.world = sim::make_world(source.world, sourced.seed);
    } else if (sourced.kind == WorldKind::kMap) {
      const VoxelGrid grid = make_grid(read_map_file(source.world));  // the tree's memory is free again
      if (!source.box) count(sim::bounds_of(grid));
      sourced.world = make_map_world(source.world, grid);
    } else {
      sourced.world = sim::read_mesh_world(source.world, {source.scale.value_or(1.0), source.up});
    }
    if (source.box) {
      sourced.world.bounds = *source.box;
      sourced.out_of_bounds = part_outside(sourced.world.mesh, *source.box);
    } else if (sourced.kind == WorldKind::kMesh) {
      count(sourced.world.bounds, most_voxels(sourced.world.mesh));
    } else if (sourced.kind == WorldKind::kBuiltIn) {
      count(sourced.world.bounds);
    }
    const auto& own = sourced.world.start;
    if (source.start)
      put_start(*source.start, "--start", sourced.world);
    else if (source.start_otherwise && !(own && sourced.world.bounds.contains(*own)))
      put_start(*source.start_otherwise, source.start_giver, sourced.world);
    if (!source.ground || !source.ground->align) return;
    if (source.box) throw BadInput("--ground: a world within a box stays where it is; leave the option out");
    if (!source.ground->height && !sourced.world.start)
      throw BadInput(
          "--ground: auto looks for the floor below the start; give --start, or the floor's height");
    // The floor may be below all that a mesh shows.
    Eigen::AlignedBox3d bounds = sourced.world.bounds;
    bounds.min().z() -= bounds.sizes().z();
    if (const auto& height = source.ground->height;
        height && !(*height >= bounds.min().z() && *height <= bounds.max().z()))
      throw BadInput("--ground: " + rounded(*height) + " m is far from the world, which is from " +
                     rounded(sourced.world.bounds.min().z()) + " to " + rounded(bounds.max().z()) +
                     " m high");
    sourced.ground_shift = sim::align_ground(sourced.world, source.ground->height, source.resolution);
  });
  return sourced;
}

}  // namespace frontlux::app
