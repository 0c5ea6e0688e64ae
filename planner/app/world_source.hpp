#pragma once

#include <frontlux/sim/mesh_file.hpp>
#include <frontlux/sim/world.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace frontlux::app {

/// Where a world comes from, as the user names it.
struct WorldSource {
  std::string world;                  ///< a built-in world, or a mesh or OctoMap file
  std::optional<std::string> seed;    ///< of a built-in world; 1 if not given
  std::optional<std::string> scale;   ///< of a mesh file: metres per unit
  std::optional<std::string> up;      ///< of a mesh file: x, y or z
  std::optional<std::string> start;   ///< x,y,z [m], in the world's frame before the ground is aligned
  std::optional<std::string> ground;  ///< align the floor: its height [m], or auto
  double resolution = 0.3;            ///< [m] of the map that the world is for
};

enum class WorldKind { kBuiltIn, kMesh, kMap };

struct SourcedWorld {
  sim::World world;
  WorldKind kind = WorldKind::kBuiltIn;
  std::uint64_t seed = 0;     ///< of a built-in world
  double ground_shift = 0.0;  ///< [m] along z, already applied to everything in `world`
  double voxels = 0.0;        ///< that its bounds hold
};

/// Adds the options that fill a source, but for the resolution and the seed, to a command.
void add_world_options(CLI::App& command, WorldSource& source);

[[nodiscard]] bool is_built_in_world(const std::string& name);

/// @throws BadInput unless the text is a whole number from 0 to 2^64 - 1
[[nodiscard]] std::uint64_t parse_seed(const std::string& text);

/// A world's number of voxels that takes much memory.
inline constexpr double kManyVoxels = 2e8;

/// Makes or reads a world, puts the start where the user wants it and aligns the ground, in this order. Warns
/// on standard error about sizes that will take much memory.
/// @throws BadInput
[[nodiscard]] SourcedWorld make_world(const WorldSource& source);

}  // namespace frontlux::app
