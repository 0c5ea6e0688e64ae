#include "mesh/raw_mesh.hpp"

#include <frontlux/sim/mesh_file.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unordered_map>

namespace frontlux::sim {
namespace {

constexpr std::uintmax_t kMaxFileSize = std::uintmax_t{1} << 30U;

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

void check_file(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) throw MeshFault("no such file");
  if (error) throw MeshFault(error.message());
  if (!std::filesystem::is_regular_file(status)) throw MeshFault("is not a regular file");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw MeshFault(error.message());
  if (size > kMaxFileSize)
    throw MeshFault("is " + std::to_string(size) + " bytes long, and 1 GiB is the limit; simplify it");
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw MeshFault("cannot be read");
  return bytes;
}

RawMesh read_raw(const std::filesystem::path& file, bool keep_frame) {
  constexpr std::array kImported = {".obj", ".stl", ".dae", ".gltf", ".glb"};
  const std::string ending = ending_of(file);
  const bool ply = ending == ".ply";
  if (!ply && std::find(kImported.begin(), kImported.end(), ending) == kImported.end())
    throw MeshFault(
        "no mesh format goes by that name; those read are .ply, .obj, .stl, .dae, .gltf and .glb");
  check_file(file);
  return ply ? parse_ply(bytes_of(file)) : import_mesh(file, ending.substr(1), keep_frame);
}

// Into a right-handed frame with z up.
Eigen::Vector3d upright(const Eigen::Vector3d& p, UpAxis up) {
  switch (up) {
    case UpAxis::kX:
      return {p.y(), p.z(), p.x()};
    case UpAxis::kY:
      return {p.x(), -p.z(), p.y()};
    case UpAxis::kZ:
      break;
  }
  return p;
}

struct HashPoint {
  std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
    std::uint64_t hash = 0;
    for (const std::uint32_t part : bits) hash = (hash ^ part) * 0x9E3779B97F4A7C15U, hash ^= hash >> 29U;
    return static_cast<std::size_t>(hash);
  }
};

// Checked, in metres, z up; equal vertices are one, and those of no triangle are left out.
TriangleMesh refine(const RawMesh& raw, double scale, UpAxis up) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(raw.vertices.size());
  for (const auto& vertex : raw.vertices) {
    // Adding 0 makes a negative zero equal to the other one, in bits too.
    points.emplace_back((upright(vertex, up) * scale + Eigen::Vector3d::Zero()).cast<float>());
    if (!points.back().allFinite())
      throw MeshFault("vertex " + std::to_string(points.size() - 1) + " is not finite in metres");
  }
  TriangleMesh mesh;
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, HashPoint> index;
  const auto index_of = [&](std::uint64_t i) {
    const Eigen::Vector3f& p = points[i];
    const std::array<std::uint32_t, 3> bits = {std::bit_cast<std::uint32_t>(p.x()),
                                               std::bit_cast<std::uint32_t>(p.y()),
                                               std::bit_cast<std::uint32_t>(p.z())};
    const auto [at, is_new] = index.try_emplace(bits, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(p);
    return at->second;
  };
  for (const auto& triangle : raw.triangles) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) {
      if (triangle[i] >= points.size())
        throw MeshFault("a triangle names vertex " + std::to_string(triangle[i]) + ", but there are only " +
                        std::to_string(points.size()));
      corner[i] = points[triangle[i]].cast<double>();
    }
    if (!((corner[1] - corner[0]).cross(corner[2] - corner[0]).norm() > 0.0)) continue;
    mesh.triangles.push_back({index_of(triangle[0]), index_of(triangle[1]), index_of(triangle[2])});
  }
  if (raw.triangles.empty()) throw MeshFault("holds no triangles");
  if (mesh.triangles.empty())
    throw MeshFault("none of its " + std::to_string(raw.triangles.size()) + " triangles has an area");
  return mesh;
}

}  // namespace

World read_mesh_world(const std::filesystem::path& file, const MeshOptions& options) {
  if (!std::isfinite(options.scale) || options.scale <= 0.0)
    throw std::invalid_argument("read_mesh_world: scale " + std::to_string(options.scale) +
                                " is not finite and positive");
  const std::string ending = ending_of(file);
  const bool y_up = ending == ".dae" || ending == ".gltf" || ending == ".glb";
  try {
    const RawMesh raw = read_raw(file, options.up.has_value());
    World world;
    world.name = file.filename().string();
    world.mesh = refine(raw, options.scale, options.up.value_or(y_up ? UpAxis::kY : UpAxis::kZ));
    world.bounds = bounds_of(world.mesh);
    return world;
  } catch (const MeshFault& fault) {
    throw std::runtime_error(file.string() + ": " + fault.what());
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(file.string() + ": holds more than fits into this machine's memory");
  }
}

}  // namespace frontlux::sim
