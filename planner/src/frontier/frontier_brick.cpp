#include "frontier/frontier_brick.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace frontlux::planner::detail {
namespace {

constexpr std::uint64_t kColumn = 0x01'01'01'01'01'01'01'01;  // the eight voxels of a layer with x = 0

// One layer of free voxels and those of the layers beside it.
struct Square {
  std::uint64_t here, west, east;
};

const Layers& free_in(const VoxelGrid& grid, const VoxelKey& corner, int dx, int dy, int dz) {
  static const Layers kNone{};
  const auto at = offset_key(corner, 8 * dx, 8 * dy, 8 * dz);
  return at ? grid.brick(*at).free : kNone;
}

// Voxels of `here` whose neighbour along x is free.
std::uint64_t beside_x(const Square& s) {
  return ((s.here & ~(kColumn << 7)) << 1) | ((s.here & ~kColumn) >> 1) | ((s.west >> 7) & kColumn) |
         ((s.east & kColumn) << 7);
}

// The layer moved by one along y in both directions; `south` and `north` are the layers that move in.
std::uint64_t beside_y(std::uint64_t here, std::uint64_t south, std::uint64_t north) {
  return (here << 8) | (here >> 8) | (south >> 56) | (north << 56);
}

Layers beside_faces(const VoxelGrid& grid, const VoxelKey& corner) {
  const Layers& here = free_in(grid, corner, 0, 0, 0);
  const Layers &west = free_in(grid, corner, -1, 0, 0), &east = free_in(grid, corner, 1, 0, 0);
  const Layers &south = free_in(grid, corner, 0, -1, 0), &north = free_in(grid, corner, 0, 1, 0);
  const Layers &below = free_in(grid, corner, 0, 0, -1), &above = free_in(grid, corner, 0, 0, 1);
  Layers beside;
  for (std::size_t z = 0; z < 8; ++z)
    beside[z] = beside_x({here[z], west[z], east[z]}) | beside_y(here[z], south[z], north[z]) |
                (z == 0 ? below[7] : here[z - 1]) | (z == 7 ? above[0] : here[z + 1]);
  return beside;
}

// Free voxels of one layer, spread to all eight neighbours in the layer and to themselves.
std::uint64_t spread_in_layer(const std::array<const Layers*, 9>& around, std::size_t z) {
  std::array<std::uint64_t, 3> rows{};
  for (std::size_t y = 0; y < 3; ++y) {
    const Square square{(*around[3 * y + 1])[z], (*around[3 * y])[z], (*around[3 * y + 2])[z]};
    rows[y] = square.here | beside_x(square);
  }
  return rows[1] | beside_y(rows[1], rows[0], rows[2]);
}

Layers beside_corners(const VoxelGrid& grid, const VoxelKey& corner) {
  const auto around = [&](int dz) {
    std::array<const Layers*, 9> layers{};
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        layers[static_cast<std::size_t>(3 * (y + 1) + x + 1)] = &free_in(grid, corner, x, y, dz);
    return layers;
  };
  std::array<std::uint64_t, 10> spread{};
  spread[0] = spread_in_layer(around(-1), 7);
  const auto beside = around(0);
  for (std::size_t z = 0; z < 8; ++z) spread[z + 1] = spread_in_layer(beside, z);
  spread[9] = spread_in_layer(around(1), 0);
  Layers all;
  for (std::size_t z = 0; z < 8; ++z) all[z] = spread[z] | spread[z + 1] | spread[z + 2];
  return all;
}

}  // namespace

Layers frontiers_in_brick(const VoxelGrid& grid, const VoxelKey& corner, const KeyBox& bounds,
                          Adjacency adjacency) {
  const Brick& brick = grid.brick(corner);
  const Layers inside = part_inside(corner, bounds);
  Layers frontiers;
  std::uint64_t any = 0;
  for (std::size_t z = 0; z < 8; ++z) any |= frontiers[z] = inside[z] & ~(brick.free[z] | brick.occupied[z]);
  if (any == 0) return frontiers;
  const Layers beside =
      adjacency == Adjacency::kFaces ? beside_faces(grid, corner) : beside_corners(grid, corner);
  for (std::size_t z = 0; z < 8; ++z) frontiers[z] &= beside[z];
  return frontiers;
}

}  // namespace frontlux::planner::detail
