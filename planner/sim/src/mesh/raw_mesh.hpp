#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::sim {

/// A mesh as its file has it: in the file's unit and frame, nothing checked.
struct RawMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint64_t, 3>> triangles;
};

/// What is wrong with a mesh file; its name is added by whoever reads it.
class MeshFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads the bytes of a PLY file: ASCII or binary of either byte order. Polygons become fans.
/// @throws MeshFault
[[nodiscard]] RawMesh parse_ply(const std::string& bytes);

/// Reads any other format through Assimp, with node transformations and COLLADA's unit applied.
/// @param ending      of the format to read, whatever the file holds: "obj"
/// @param keep_frame  if false, a COLLADA file's frame is turned to have y up
/// @throws MeshFault
[[nodiscard]] RawMesh import_mesh(const std::filesystem::path& file, const std::string& ending,
                                  bool keep_frame);

}  // namespace frontlux::sim
