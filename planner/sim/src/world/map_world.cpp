#include "world/cell_surface.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/map_world.hpp>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::sim {
namespace {

constexpr std::size_t kMaxFaces = std::size_t{1} << 26U;
constexpr std::size_t kMaxBlockSides = std::size_t{1} << 25U;  // of large blocks
constexpr std::size_t kMaxSides = std::size_t{1} << 30U;       // compared; some ten seconds

using Cell = std::array<int, 3>;

bool is_occupied(const VoxelGrid& grid, const Cell& c) {
  const auto key = offset_key({}, c[0], c[1], c[2]);
  return key && grid.at(*key) == Occupancy::kOccupied;
}

class SurfaceFaces {
 public:
  explicit SurfaceFaces(const VoxelGrid& grid) : grid_(grid) {}

  // Adds the faces of a cube of `edge` cells a side, all occupied, that border on other cells.
  void add(const VoxelKey& corner, int edge) {
    const Cell low = {corner.x, corner.y, corner.z};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        Cell c = low, beyond = low;
        if (side == 1) c[axis] += edge - 1;
        beyond[axis] = c[axis] + (side == 0 ? -1 : 1);
        compared_ += static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
        if (compared_ > kMaxSides) refuse();
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = 0; i < edge; ++i)
          for (int j = 0; j < edge; ++j) {
            beyond[u] = low[u] + i;
            beyond[v] = low[v] + j;
            if (is_occupied(grid_, beyond)) continue;
            if (++count_ > allowed_) refuse();
            faces_[axis][static_cast<std::size_t>(side)].push_back({c[axis] + side, beyond[u], beyond[v]});
          }
      }
  }

  // Blocks of one state take few bytes of a file, and have far fewer faces than sides where they are many.
  void allow(const Brick* brick) {
    constexpr std::size_t kOfBlock = 512, kOfBrick = 1536;
    allowed_ = std::min(allowed_ + (brick == nullptr ? kOfBlock : kOfBrick), kMaxFaces);
  }

  // A few bytes of a file can stand for trillions of sides, so large blocks are counted before any is added.
  void expect(int edge) {
    constexpr std::size_t kUsual = std::size_t{1} << 15;
    const std::size_t sides = 6 * static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
    expected_ += sides - std::min(sides, kUsual);
    if (expected_ > kMaxBlockSides) refuse();
  }

  [[nodiscard]] CellFaces take() {
    if (count_ == 0) throw std::runtime_error("the map has no occupied voxel, so there is no world to see");
    return std::move(faces_);
  }

 private:
  [[noreturn]] void refuse() const {
    throw std::runtime_error("the map's occupied voxels have more than " + std::to_string(allowed_) +
                             " faces, or lie in large blocks with more than " +
                             std::to_string(kMaxBlockSides) + " sides; use a coarser or smaller map");
  }

  const VoxelGrid& grid_;
  CellFaces faces_;
  std::size_t allowed_ = std::size_t{1} << 24U;  // that any map may have: 0.4 GB
  std::size_t count_ = 0, compared_ = 0, expected_ = 0;
};

}  // namespace

Eigen::AlignedBox3d bounds_of(const VoxelGrid& grid) {
  const auto known = grid.known_bounds();
  if (!known) return {};
  const auto face_at = [&](int line) { return lower_face(grid.lattice(), line); };
  const auto& [low, high] = *known;
  return {Eigen::Vector3d(face_at(low.x), face_at(low.y), face_at(low.z)),
          Eigen::Vector3d(face_at(high.x + 1), face_at(high.y + 1), face_at(high.z + 1))};
}

World make_map_world(const VoxelGrid& grid) {
  SurfaceFaces faces(grid);
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    faces.allow(brick);
    if (brick == nullptr && state == Occupancy::kOccupied) faces.expect(1 << block.log2_edge);
  });
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    const int edge = 1 << block.log2_edge;
    if (brick == nullptr) {
      if (state == Occupancy::kOccupied) faces.add(block.corner, edge);
      return;
    }
    for_each_key(cube(block.corner, edge), [&](const VoxelKey& key) {
      if (brick->at(key) == Occupancy::kOccupied) faces.add(key, 1);
    });
  });
  const auto face_at = [&](int line) { return lower_face(grid.lattice(), line); };
  World world;
  world.mesh =
      mesh_of(faces.take(), [&](int, std::int32_t line) { return static_cast<float>(face_at(line)); });
  world.bounds = bounds_of(grid);
  return world;
}

}  // namespace frontlux::sim
