#include "embree/unit_boxes.hpp"

#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace frontlux::detail {
namespace {

// A cube of voxels with one layer of neighbours around it: word [z][y], bit x; voxel 0 of the cube has
// index 1.
constexpr int kUnitEdge = BoxGroup::kUnitEdge;
constexpr int kPadded = kUnitEdge + 2;
using Row = std::uint32_t;
using Rows = std::array<std::array<Row, kPadded>, kPadded>;
constexpr Row kInside = ((Row{1} << kUnitEdge) - 1) << 1;

using Cell = std::array<int, 3>;  // index into Rows: x, y, z

// The blockers of a brick, layer by layer. Beyond the key range nothing is free, so a ray never comes from
// there: what lies outside counts as blocker.
std::array<std::uint64_t, 8> blocked_layers(const VoxelGrid& grid, UnknownPolicy unknown, int x, int y,
                                            int z) {
  constexpr int kEnd = Lattice::kKeysPerAxis;
  std::array<std::uint64_t, 8> layers;
  if (x < 0 || y < 0 || z < 0 || x >= kEnd || y >= kEnd || z >= kEnd) {
    layers.fill(~std::uint64_t{0});
    return layers;
  }
  const Brick& brick = grid.brick(as_key({x, y, z}));
  if (unknown == UnknownPolicy::kPass) return brick.occupied;
  for (std::size_t i = 0; i < 8; ++i) layers[i] = ~brick.free[i];
  return layers;
}

// The range of padded indices that a brick with this offset from the corner covers: a brick beside the cube
// gives only the layer that touches it.
struct Range {
  int begin, end;
};
constexpr Range padded_range(int offset) { return {std::max(offset + 1, 0), std::min(offset + 9, kPadded)}; }

Rows load_blocked(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& corner) {
  Rows rows{};
  for (int bz = -8; bz <= kUnitEdge; bz += 8)
    for (int by = -8; by <= kUnitEdge; by += 8)
      for (int bx = -8; bx <= kUnitEdge; bx += 8) {
        const auto beside = [](int offset) { return static_cast<int>(offset < 0 || offset >= kUnitEdge); };
        if (beside(bx) + beside(by) + beside(bz) > 1) continue;  // shares no face with the cube
        const auto layers = blocked_layers(grid, unknown, corner.x + bx, corner.y + by, corner.z + bz);
        const Range zs = padded_range(bz), ys = padded_range(by);
        for (int z = zs.begin; z < zs.end; ++z) {
          const std::uint64_t layer = layers[static_cast<std::size_t>(z - bz - 1)];
          for (int y = ys.begin; y < ys.end; ++y) {
            const auto eight = static_cast<Row>((layer >> (8 * (y - by - 1))) & 0xFF);
            Row& row = rows[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)];
            row |= bx < 0 ? eight >> 7 : eight << (bx + 1);
          }
        }
      }
  return rows;
}

// Blockers inside the cube with a neighbour that does not block.
Rows shell_of(const Rows& blocked) {
  Rows shell{};
  for (std::size_t z = 1; z <= kUnitEdge; ++z)
    for (std::size_t y = 1; y <= kUnitEdge; ++y) {
      const Row row = blocked[z][y];
      const Row buried = (row << 1) & (row >> 1) & blocked[z][y - 1] & blocked[z][y + 1] & blocked[z - 1][y] &
                         blocked[z + 1][y];
      shell[z][y] = row & ~buried & kInside;
    }
  return shell;
}

// Grows boxes through blockers, from uncovered shell voxels, by the face that covers most of them; a face
// that covers no new one is not worth its larger box.
class Grower {
 public:
  Grower(const Rows& blocked, Rows& uncovered) : blocked_(blocked), uncovered_(uncovered) {}

  void grow_from(const Cell& seed) {
    low_ = high_ = seed;
    while (grow_best_face()) {
    }
    for_each_row(low_, high_, [&](std::size_t z, std::size_t y, Row mask) { uncovered_[z][y] &= ~mask; });
  }
  [[nodiscard]] const Cell& low() const { return low_; }
  [[nodiscard]] const Cell& high() const { return high_; }

 private:
  static Row mask(int x_low, int x_high) { return ((Row{1} << (x_high - x_low + 1)) - 1) << x_low; }

  template <class Visit>
  static void for_each_row(const Cell& low, const Cell& high, const Visit& visit) {
    const Row bits = mask(low[0], high[0]);
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        visit(static_cast<std::size_t>(z), static_cast<std::size_t>(y), bits);
  }

  // Number of uncovered shell voxels in a slab; 0 if any voxel of it does not block.
  [[nodiscard]] int gain(const Cell& low, const Cell& high) const {
    int sum = 0;
    bool all_block = true;
    for_each_row(low, high, [&](std::size_t z, std::size_t y, Row bits) {
      all_block = all_block && (blocked_[z][y] & bits) == bits;
      sum += std::popcount(uncovered_[z][y] & bits);
    });
    return all_block ? sum : 0;
  }

  bool grow_best_face() {
    int best = 0;
    Cell best_low = low_, best_high = high_;
    for (const int side : {-1, 1})
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Cell slab_low = low_, slab_high = high_, grown_low = low_, grown_high = high_;
        int& face = side < 0 ? grown_low[axis] : grown_high[axis];
        face += side;
        if (face < 1 || face > kUnitEdge) continue;
        slab_low[axis] = slab_high[axis] = face;
        const int covered = gain(slab_low, slab_high);
        if (covered <= best) continue;
        best = covered;
        best_low = grown_low;
        best_high = grown_high;
      }
    low_ = best_low;
    high_ = best_high;
    return best > 0;
  }

  const Rows& blocked_;
  Rows& uncovered_;
  Cell low_{}, high_{};
};

// Whether a unit and all around it is one solid piece, or free of blockers: most of a map's units.
bool has_no_shell(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& corner) {
  const auto slot = [&tile = grid.tile(corner), &corner](int x, int y, int z) {
    return tile
        .slots[static_cast<std::size_t>(Tile::index(as_key({corner.x + x, corner.y + y, corner.z + z})))];
  };
  const auto open = [unknown](std::uint16_t s) {
    return s == static_cast<std::uint16_t>(Occupancy::kFree) ||
           (s == static_cast<std::uint16_t>(Occupancy::kUnknown) && unknown == UnknownPolicy::kPass);
  };
  bool all_open = true;
  for (int i = 0; i < 8; ++i) all_open = all_open && open(slot((i & 1) * 8, (i & 2) * 4, (i & 4) * 2));
  if (all_open) return true;
  bool all = true, none = true;
  for (int bz = 0; bz < kUnitEdge; bz += 8)
    for (int by = 0; by < kUnitEdge; by += 8)
      for (int bx = 0; bx < kUnitEdge; bx += 8)
        for (const std::uint64_t layer :
             blocked_layers(grid, unknown, corner.x + bx, corner.y + by, corner.z + bz)) {
          all = all && layer == ~std::uint64_t{0};
          none = none && layer == 0;
        }
  if (none) return true;
  if (!all) return false;
  for (int a = 0; a < kUnitEdge; a += 8)
    for (int b = 0; b < kUnitEdge; b += 8)
      for (const int side : {-8, kUnitEdge}) {
        const std::array<std::array<int, 3>, 3> besides = {{{side, a, b}, {a, side, b}, {a, b, side}}};
        for (const auto& [x, y, z] : besides)
          for (const std::uint64_t layer :
               blocked_layers(grid, unknown, corner.x + x, corner.y + y, corner.z + z))
            if (layer != ~std::uint64_t{0}) return false;
      }
  return true;
}

}  // namespace

void append_unit_boxes(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& corner,
                       std::vector<PackedBox>& boxes) {
  if (has_no_shell(grid, unknown, corner)) return;
  const Rows blocked = load_blocked(grid, unknown, corner);
  Rows uncovered = shell_of(blocked);
  const auto cell = [&](const Cell& c) {
    constexpr int kMask = BoxGroup::kEdge - 1;
    return std::array{(corner.x & kMask) + c[0] - 1, (corner.y & kMask) + c[1] - 1,
                      (corner.z & kMask) + c[2] - 1};
  };
  Grower grower(blocked, uncovered);
  for (int z = 1; z <= kUnitEdge; ++z)
    for (int y = 1; y <= kUnitEdge; ++y) {
      Row& row = uncovered[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)];
      while (row != 0) {
        grower.grow_from({std::countr_zero(row), y, z});
        boxes.push_back(pack(cell(grower.low()), cell(grower.high())));
      }
    }
}

}  // namespace frontlux::detail
