#include <frontlux/file.hpp>

#include <frontlux/sim/mesh_file.hpp>

#include <bit>
#include <cstdint>
#include <ostream>
#include <string>

namespace frontlux::sim {
namespace {

// Little-endian on every machine.
void append(std::string& bytes, std::uint32_t word) {
  for (unsigned shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<char>((word >> shift) & 0xFFU));
}

std::string ply_of(const TriangleMesh& mesh) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment frontlux world: metres, z up\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + 12 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const auto& vertex : mesh.vertices)
    for (int i = 0; i < 3; ++i) append(bytes, std::bit_cast<std::uint32_t>(vertex[i]));
  for (const auto& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (const std::uint32_t index : triangle) append(bytes, index);
  }
  return bytes;
}

}  // namespace

void write_ply(const std::filesystem::path& file, const TriangleMesh& mesh) {
  const std::string bytes = ply_of(mesh);
  write_file(
      file, [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
}

}  // namespace frontlux::sim
