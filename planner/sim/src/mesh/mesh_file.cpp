#include "mesh/mesh_import.hpp"

#include <frontlux/file.hpp>
#include <frontlux/sim/mesh_file.hpp>
#include <frontlux/split_mix.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <new>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace frontlux::sim {
namespace {

constexpr std::uint64_t kMaxFileSize = std::uint64_t{1} << 30U;

// Of one in words: Assimp takes what there is. The others, which may begin with "solid" as well, tell their
// length.
void check_end_of_stl(const std::filesystem::path& file, std::string_view bytes) {
  constexpr std::size_t kHeader = 80, kTriangle = 50, kEnd = 4096;  // bytes; the last line is in the last
  std::size_t announced = 0;
  if (bytes.size() >= kHeader + 4)
    announced = kHeader + 4 + kTriangle * from_bytes<std::uint32_t>(&bytes[kHeader], std::endian::little);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if ((announced != 0 && announced <= bytes.size()) || first == std::string_view::npos ||
      !bytes.substr(first).starts_with("solid"))
    return;
  std::string end(bytes.substr(bytes.size() - std::min(bytes.size(), kEnd)));
  for (char& c : end)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const std::size_t last = std::min(end.rfind("endsolid"), end.rfind("end solid"));
  if (last == std::string::npos || end.find("facet", end.find('\n', last)) != std::string::npos)
    fail(file, "ends before its last line, which begins with 'endsolid'",
         "the file is incomplete: get another copy of it");
}

io::RawMesh read_raw(const std::filesystem::path& file, bool keep_frame) {
  constexpr std::array kImported = {".obj", ".stl", ".dae", ".gltf", ".glb"};
  const std::string extension = lower_extension(file);
  if (extension == ".ply") return io::read_ply(file, kMaxFileSize);
  if (std::ranges::find(kImported, extension) == kImported.end())
    fail(file, "is no mesh of a known format", "give a .ply, .obj, .stl, .dae, .gltf or .glb file");
  const std::string bytes = read_file(file, kMaxFileSize);  // Assimp opens it again, and those that it names
  if (extension == ".stl") check_end_of_stl(file, bytes);
  return import_mesh(file, extension.substr(1), keep_frame);
}

// Into a right-handed frame with z up.
Eigen::Vector3d upright(const Eigen::Vector3d& p, UpAxis up) {
  if (up == UpAxis::kX) return {p.y(), p.z(), p.x()};
  return up == UpAxis::kY ? Eigen::Vector3d(p.x(), -p.z(), p.y()) : p;
}

using Bits = std::array<std::uint32_t, 3>;  // of a vertex

struct HashBits {
  std::size_t operator()(const Bits& bits) const {
    return SplitMix64::mix(SplitMix64::mix(std::uint64_t{bits[0]} << 32U | bits[1]) + bits[2]);
  }
};

// Checked, in metres, z up; equal vertices are one, and those of no triangle are left out.
TriangleMesh refine(const std::filesystem::path& file, const io::RawMesh& raw, double scale, UpAxis up) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(raw.vertices.size());
  for (const auto& vertex : raw.vertices) {
    // Adding 0 makes a negative zero equal to the other one, in bits too.
    points.emplace_back((upright(vertex, up) * scale + Eigen::Vector3d::Zero()).cast<float>());
    if (!points.back().allFinite())
      fail(file, "vertex " + std::to_string(points.size() - 1) + " is not finite in metres",
           "repair the mesh, or give a smaller scale");
  }
  TriangleMesh mesh;
  std::unordered_map<Bits, std::uint32_t, HashBits> index;
  const auto index_of = [&](std::uint64_t i) {
    const Eigen::Vector3f& p = points[i];
    const Bits bits = {std::bit_cast<std::uint32_t>(p.x()), std::bit_cast<std::uint32_t>(p.y()),
                       std::bit_cast<std::uint32_t>(p.z())};
    const auto [at, is_new] = index.try_emplace(bits, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(p);
    return at->second;
  };
  for (const auto& triangle : raw.triangles) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) {
      if (triangle[i] >= points.size())
        fail(file,
             "a triangle names vertex " + std::to_string(triangle[i]) + ", but there are only " +
                 std::to_string(points.size()),
             "the file is damaged: get another copy of it");
      corner[i] = points[triangle[i]].cast<double>();
    }
    if (!((corner[1] - corner[0]).cross(corner[2] - corner[0]).norm() > 0.0)) continue;
    mesh.triangles.push_back({index_of(triangle[0]), index_of(triangle[1]), index_of(triangle[2])});
  }
  if (raw.triangles.empty()) fail(file, "holds no triangles", "give a file with a surface");
  if (mesh.triangles.empty())
    fail(file, "none of its " + std::to_string(raw.triangles.size()) + " triangles has an area",
         "give a file with a surface");
  return mesh;
}

std::string ply_of(const TriangleMesh& mesh) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment frontlux world: metres, z up\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + 12 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const auto& vertex : mesh.vertices)
    for (const float coordinate : vertex) append_number(bytes, std::bit_cast<std::uint32_t>(coordinate));
  for (const auto& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (const std::uint32_t index : triangle) append_number(bytes, index);
  }
  return bytes;
}

}  // namespace

World read_mesh_world(const std::filesystem::path& file, const MeshOptions& options) {
  if (!std::isfinite(options.scale) || options.scale <= 0.0)
    throw std::invalid_argument("read_mesh_world: scale " + std::to_string(options.scale) +
                                " is not finite and positive");
  const std::string extension = lower_extension(file);
  const bool y_up = extension == ".dae" || extension == ".gltf" || extension == ".glb";
  try {
    World world;
    world.name = file.filename().string();
    world.mesh = refine(file, read_raw(file, options.up.has_value()), options.scale,
                        options.up.value_or(y_up ? UpAxis::kY : UpAxis::kZ));
    world.bounds = bounds_of(world.mesh);
    return world;
  } catch (const std::bad_alloc&) {
    fail(file, "holds more than fits into this machine's memory", "simplify the mesh");
  }
}

void write_ply(const std::filesystem::path& file, const TriangleMesh& mesh) {
  write_file(file, ply_of(mesh));
}

}  // namespace frontlux::sim
