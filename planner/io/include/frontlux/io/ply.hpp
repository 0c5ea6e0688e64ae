#pragma once

#include <frontlux/export.hpp>
#include <frontlux/file.hpp>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace frontlux::io {

/// Vertices and triangles as a file has them: in the file's unit and frame, no coordinate or index checked.
struct RawMesh {
  /// [m]
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint64_t, 3>> triangles;  ///< indices of vertices
};

/// Reads a PLY file, ascii or binary of either byte order: x, y and z of the elements `vertex`, and of the
/// elements `face` the list `vertex_indices` or `vertex_index`, each polygon as a fan of triangles. All other
/// properties and elements are checked and left out. Time and memory are bounded by the size of the file,
/// whatever its header says.
/// @throws std::runtime_error naming the file, the line or byte, what is wrong there, and what to do
[[nodiscard]] FRONTLUX_EXPORT RawMesh read_ply(const std::filesystem::path& file,
                                               std::uint64_t max_bytes = kMaxFileBytes);

}  // namespace frontlux::io
