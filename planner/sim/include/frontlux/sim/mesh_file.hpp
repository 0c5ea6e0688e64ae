#pragma once

#include <frontlux/sim/world.hpp>

#include <filesystem>
#include <optional>

namespace frontlux::sim {

/// The axis of a file's frame that points up.
enum class UpAxis { kX, kY, kZ };

struct MeshOptions {
  double scale = 1.0;  ///< metres per unit of the file; COLLADA's own unit is applied before
  std::optional<UpAxis> up =
      std::nullopt;  ///< if nothing: what the format says (COLLADA: the file; glTF: y), else z
};

/// Reads a mesh, by its name's ending: .ply, .obj, .stl, .dae, .gltf, .glb. Polygons become triangles, node
/// transformations are applied, triangles without area are left out. The world's name is the file's.
/// @throws std::invalid_argument unless the scale is finite and positive
/// @throws std::runtime_error naming the file, what is wrong and what to do, if it cannot be read, is larger
///         than 1 GiB, holds a number that is not finite, a face of a vertex that is not there, or no
///         triangle with an area
///
/// All but PLY is read in a child process, which may take 512 MiB and 200 times the size of the files that it
/// reads, and 8 s of a processor and 2 s for each MiB, and may only read files in the mesh's folder and
/// below.
[[nodiscard]] World read_mesh_world(const std::filesystem::path& file, const MeshOptions& options = {});

/// Writes a binary PLY file, whole or not at all: a file of that name stays as it was until the new one is
/// complete.
/// @throws std::runtime_error naming the file, if it cannot be written
void write_ply(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace frontlux::sim
