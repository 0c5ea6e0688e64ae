#include "world/cell_surface.hpp"

#include <frontlux/sim/map_world.hpp>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::sim {
namespace {

constexpr std::size_t kMaxFaces = std::size_t{1} << 26U;
constexpr std::size_t kMaxSides = std::size_t{1} << 30U;  // looked at; some ten seconds

using Cell = std::array<int, 3>;

bool is_occupied(const VoxelGrid& grid, const Cell& c) {
  for (const int k : c)
    if (k < 0 || k >= Lattice::kKeysPerAxis) return false;
  const auto along = [&](std::size_t i) { return static_cast<std::uint16_t>(c[i]); };
  return grid.at({along(0), along(1), along(2)}) == Occupancy::kOccupied;
}

class Surface {
 public:
  explicit Surface(const VoxelGrid& grid) : grid_(grid) {}

  // Looks at the sides of all cells from `low`, a block of `edge` cells all of which are occupied.
  void add(const Cell& low, int edge) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        Cell c = low, beyond = low;
        if (side == 1) c[axis] += edge - 1;
        beyond[axis] = c[axis] + (side == 0 ? -1 : 1);
        looked_at_ += static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
        if (looked_at_ > kMaxSides) refuse();
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = 0; i < edge; ++i)
          for (int j = 0; j < edge; ++j) {
            beyond[u] = low[u] + i;
            beyond[v] = low[v] + j;
            if (is_occupied(grid_, beyond)) continue;
            if (++count_ > kMaxFaces) refuse();
            faces_[axis][static_cast<std::size_t>(side)].push_back({c[axis] + side, beyond[u], beyond[v]});
          }
      }
  }

  [[nodiscard]] CellFaces take() {
    if (count_ == 0) throw std::runtime_error("the map has no occupied voxel, so there is no world to see");
    return std::move(faces_);
  }

 private:
  [[noreturn]] static void refuse() {
    throw std::runtime_error("the map's occupied voxels have more than " + std::to_string(kMaxFaces) +
                             " faces, or lie in blocks too large to look at; use a coarser or smaller map");
  }

  const VoxelGrid& grid_;
  CellFaces faces_;
  std::size_t count_ = 0, looked_at_ = 0;
};

}  // namespace

World make_map_world(const VoxelGrid& grid) {
  Surface surface(grid);
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    const Cell low = {block.corner.x, block.corner.y, block.corner.z};
    if (brick == nullptr) {
      if (state == Occupancy::kOccupied) surface.add(low, 1 << block.log2_edge);
      return;
    }
    const int edge = 1 << block.log2_edge;
    for (int x = 0; x < edge; ++x)
      for (int y = 0; y < edge; ++y)
        for (int z = 0; z < edge; ++z) {
          const Cell c = {low[0] + x, low[1] + y, low[2] + z};
          if (is_occupied(grid, c)) surface.add(c, 1);
        }
  });
  const auto face_at = [&](int line) { return (line - Lattice::kOrigin) * grid.resolution(); };
  World world;
  world.mesh =
      mesh_of(surface.take(), [&](int, std::int32_t line) { return static_cast<float>(face_at(line)); });
  const KeyBox known = grid.known_bounds().value();
  world.bounds.extend(Eigen::Vector3d(face_at(known.min.x), face_at(known.min.y), face_at(known.min.z)));
  world.bounds.extend(
      Eigen::Vector3d(face_at(known.max.x + 1), face_at(known.max.y + 1), face_at(known.max.z + 1)));
  return world;
}

}  // namespace frontlux::sim
