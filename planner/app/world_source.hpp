#pragma once

#include "command.hpp"

#include <frontlux/sim/mesh_file.hpp>
#include <frontlux/sim/world.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace frontlux::app {

/// Whether a world is moved along z so that its floor lies right for mapping.
struct GroundAlignment {
  bool align = false;
  std::optional<double> height = std::nullopt;  ///< [m] of the floor; nothing: it is below the start
};
/// "off", "auto" or a height. @throws BadInput
void read(std::string_view word, GroundAlignment& ground);

/// Where a world comes from, as the user names it.
struct WorldSource {
  std::string world;                     ///< a built-in world, or a mesh or OctoMap file
  std::optional<std::uint64_t> seed;     ///< of a built-in world; 1 if not given
  std::optional<double> scale;           ///< of a mesh file: metres per unit
  std::optional<sim::UpAxis> up;         ///< of a mesh file
  std::optional<Eigen::Vector3f> start;  ///< [m] in the world's frame before the ground is aligned
  /// [m] The start where the world knows none within its bounds, and who gives it, in messages.
  std::optional<Eigen::Vector3f> start_otherwise;
  std::string start_giver;
  std::optional<Eigen::AlignedBox3d> box;  ///< [m] the bounds, if not those of the mesh; the floor stays then
  std::optional<GroundAlignment> ground;   ///< off if not given
  double resolution = 0.3;                 ///< [m] of the map that the world is for
};

enum class WorldKind { kBuiltIn, kMesh, kMap };

struct SourcedWorld {
  sim::World world;
  WorldKind kind = WorldKind::kBuiltIn;
  std::uint64_t seed = 0;     ///< of a built-in world
  double ground_shift = 0.0;  ///< [m] along z, already applied to everything in `world`
  double voxels = 0.0;        ///< that its bounds hold
  /// Part of its surface's area that lies outside the box that it is to be explored in, 0 to 1.
  double out_of_bounds = 0.0;
};

/// Adds the options that fill a source, but for the world itself and the seed, to a command.
/// @param ground_default  what --help says
void add_world_options(Command& command, WorldSource& source, const char* ground_default);

[[nodiscard]] bool is_built_in_world(const std::string& name);

/// A world's number of voxels that takes much memory.
inline constexpr double kManyVoxels = 2e8;

/// Makes or reads a world, puts the start where the user wants it and aligns the ground, in this order. Warns
/// on standard error about sizes that will take much memory.
/// @throws BadInput
[[nodiscard]] SourcedWorld make_world(const WorldSource& source);

}  // namespace frontlux::app
