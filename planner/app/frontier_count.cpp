#include "frontier_count.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <unordered_set>
#include <vector>

namespace frontlux::app {
namespace {

constexpr std::uint64_t kRow = 0xFF;                          // of eight voxels along x, y = 0
constexpr std::uint64_t kColumn = 0x01'01'01'01'01'01'01'01;  // of eight voxels along y, x = 0
constexpr int kBricksPerAxis = Lattice::kKeysPerAxis / 8;

// Place of a brick among all bricks.
using Place = std::array<int, 3>;

struct PlaceBox {
  Place min, max;  // both included
  [[nodiscard]] bool contains(const Place& p) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (p[a] < min[a] || p[a] > max[a]) return false;
    return true;
  }
};

VoxelKey key_of(const Place& place) {
  const auto along = [](int i) { return static_cast<std::uint16_t>(i * 8); };
  return {along(place[0]), along(place[1]), along(place[2])};
}

Place place_of(const VoxelKey& key) { return {key.x / 8, key.y / 8, key.z / 8}; }

// The six sides of a cube are numbered -x, +x, -y, +y, -z, +z; the one across from `side` is `side ^ 1`.
constexpr std::size_t kSides = 6;

Place next_to(Place place, std::size_t side) {
  place[side / 2] += side % 2 == 0 ? -1 : 1;
  return place;
}

bool free_along(const Brick& brick, std::size_t side) {
  if (side == 4) return brick.free[0] != 0;
  if (side == 5) return brick.free[7] != 0;
  std::uint64_t square = 0;
  for (const std::uint64_t layer : brick.free) square |= layer;
  constexpr std::array<std::uint64_t, 4> kEdges = {kColumn, kColumn << 7, kRow, kRow << 56};
  return (square & kEdges[side]) != 0;
}

// Bits of a byte from `first` to `last`, clipped to the byte.
std::uint64_t span_of_byte(int first, int last) {
  return (kRow << std::clamp(first, 0, 8)) & (kRow >> std::clamp(7 - last, 0, 8)) & kRow;
}

// A face of a free block, as the bricks on its other side.
struct Surface {
  std::size_t side;
  PlaceBox bricks;
};

class FrontierCount {
 public:
  FrontierCount(const VoxelGrid& grid, const KeyBox& box)
      : grid_(grid), box_(box), places_{place_of(box.min), place_of(box.max)} {}

  // What lies in a brick of mixed states and in the unknown bricks around it.
  void add_brick(const Place& place, const Brick& brick) {
    count_ += frontiers_in(place);
    for (std::size_t side = 0; side < kSides; ++side)
      if (free_along(brick, side)) add_unknown_brick(next_to(place, side), side ^ 1U);
  }

  void add_surface(const Surface& surface) {
    const auto& [min, max] = surface.bricks;
    for (int z = min[2]; z <= max[2]; ++z)
      for (int y = min[1]; y <= max[1]; ++y)
        for (int x = min[0]; x <= max[0]; ++x) add_unknown_brick({x, y, z}, surface.side ^ 1U);
  }

  // Bricks of the box that lie next to a block, beyond one of its sides.
  [[nodiscard]] Surface surface(const Block& block, std::size_t side) const {
    Surface surface{side, {place_of(block.corner), place_of(block.corner)}};
    auto& [min, max] = surface.bricks;
    const int edge = 1 << (block.log2_edge - 3);
    for (std::size_t a = 0; a < 3; ++a) max[a] += edge - 1;
    const std::size_t axis = side / 2;
    min[axis] = max[axis] = side % 2 == 0 ? min[axis] - 1 : max[axis] + 1;
    for (std::size_t a = 0; a < 3; ++a) {
      min[a] = std::max(min[a], places_.min[a]);
      max[a] = std::min(max[a], places_.max[a]);
    }
    return surface;
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  // Adds an unknown brick when it is reached from the first of its sides that has free voxels, so that it is
  // added once.
  void add_unknown_brick(const Place& place, std::size_t from_side) {
    if (!places_.contains(place) || grid_.brick(key_of(place)) != Brick{}) return;
    for (std::size_t side = 0; side < from_side; ++side) {
      const Place neighbour = next_to(place, side);
      if (inside(neighbour) && free_along(grid_.brick(key_of(neighbour)), side ^ 1U)) return;
    }
    count_ += frontiers_in(place);
  }

  [[nodiscard]] static bool inside(const Place& place) {
    return std::all_of(place.begin(), place.end(), [](int i) { return i >= 0 && i < kBricksPerAxis; });
  }

  [[nodiscard]] std::uint64_t frontiers_in(const Place& place) const {
    static const Brick kNothing{};
    const Brick& brick = grid_.brick(key_of(place));
    std::array<const Brick*, kSides> around;
    for (std::size_t side = 0; side < kSides; ++side) {
      const Place neighbour = next_to(place, side);
      around[side] = inside(neighbour) ? &grid_.brick(key_of(neighbour)) : &kNothing;
    }
    const VoxelKey corner = key_of(place);
    std::uint64_t square = 0;
    const std::uint64_t row = span_of_byte(box_.min.x - corner.x, box_.max.x - corner.x);
    for (int y = std::max(0, box_.min.y - corner.y); y <= std::min(7, box_.max.y - corner.y); ++y)
      square |= row << (8 * y);
    const int first = std::max(0, box_.min.z - corner.z), last = std::min(7, box_.max.z - corner.z);
    std::uint64_t voxels = 0;
    for (auto z = static_cast<std::size_t>(first); z <= static_cast<std::size_t>(last); ++z) {
      const std::uint64_t free = brick.free[z];
      const std::uint64_t beside = ((free & ~(kColumn << 7)) << 1) | ((free & ~kColumn) >> 1) | (free << 8) |
                                   (free >> 8) | ((around[0]->free[z] >> 7) & kColumn) |
                                   ((around[1]->free[z] & kColumn) << 7) | (around[2]->free[z] >> 56) |
                                   (around[3]->free[z] << 56) |
                                   (z == 0 ? around[4]->free[7] : brick.free[z - 1]) |
                                   (z == 7 ? around[5]->free[0] : brick.free[z + 1]);
      voxels += static_cast<std::uint64_t>(std::popcount(beside & square & ~(free | brick.occupied[z])));
    }
    return voxels;
  }

  const VoxelGrid& grid_;
  KeyBox box_;
  PlaceBox places_;
  std::uint64_t count_ = 0;
};

std::uint64_t bricks_in(const PlaceBox& box) {
  std::uint64_t bricks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.max[a] < box.min[a]) return 0;
    bricks *= static_cast<std::uint64_t>(box.max[a] - box.min[a] + 1);
  }
  return bricks;
}

// One number for a block, to look it up by.
std::uint64_t name_of(const Block& block) {
  return (static_cast<std::uint64_t>(block.corner.x) << 32) |
         (static_cast<std::uint64_t>(block.corner.y) << 16) | block.corner.z |
         (static_cast<std::uint64_t>(block.log2_edge) << 48);
}

std::optional<std::uint64_t> name_of_neighbour(Block block, std::size_t side) {
  const std::array along = {&block.corner.x, &block.corner.y, &block.corner.z};
  const int moved = *along[side / 2] + (side % 2 == 0 ? -1 : 1) * (1 << block.log2_edge);
  if (moved < 0 || moved >= Lattice::kKeysPerAxis) return std::nullopt;
  *along[side / 2] = static_cast<std::uint16_t>(moved);
  return name_of(block);
}

}  // namespace

std::optional<std::uint64_t> count_frontiers(const VoxelGrid& grid, const KeyBox& box,
                                             std::uint64_t max_surface_bricks) {
  FrontierCount frontiers(grid, box);
  std::vector<Block> free_blocks;
  std::unordered_set<std::uint64_t> known;  // uniform blocks, in which there is no frontier
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    if (brick != nullptr) return;
    known.insert(name_of(block));
    if (state == Occupancy::kFree) free_blocks.push_back(block);
  });
  const auto for_each_surface = [&](const auto& visit) {
    for (const Block& block : free_blocks)
      for (std::size_t side = 0; side < kSides; ++side) {
        const auto neighbour = name_of_neighbour(block, side);
        if (neighbour && !known.contains(*neighbour)) visit(block, frontiers.surface(block, side));
      }
  };
  std::uint64_t bricks = 0;  // of a free brick the storage already bounds the number
  for_each_surface([&](const Block& block, const Surface& surface) {
    if (block.log2_edge > Brick::kLog2) bricks += bricks_in(surface.bricks);
  });
  if (bricks > max_surface_bricks) return std::nullopt;
  for_each_surface([&](const Block&, const Surface& surface) { frontiers.add_surface(surface); });
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy) {
    if (brick != nullptr) frontiers.add_brick(place_of(block.corner), *brick);
  });
  return frontiers.count();
}

}  // namespace frontlux::app
