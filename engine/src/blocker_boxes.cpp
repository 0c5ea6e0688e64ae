#include "blocker_boxes.hpp"

#include "batch.hpp"
#include "walk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace frontlux::detail {
namespace {

// A cube of voxels with one layer of neighbours around it: word [z][y], bit x; voxel 0 of the cube has
// index 1.
constexpr int kPadded = kUnitEdge + 2;
using Row = std::uint32_t;
using Rows = std::array<std::array<Row, kPadded>, kPadded>;
constexpr Row kInside = ((Row{1} << kUnitEdge) - 1) << 1;

using Cell = std::array<int, 3>;  // index into Rows: x, y, z

// Whether the voxels of an aligned row of eight block, as eight bits. Beyond the key range nothing is free,
// so a ray never comes from there: what lies outside counts as blocker.
Row blocked_row_of_eight(const VoxelGrid& grid, UnknownPolicy unknown, int x, int y, int z) {
  constexpr int kEnd = Lattice::kKeysPerAxis;
  if (x < 0 || y < 0 || z < 0 || x >= kEnd || y >= kEnd || z >= kEnd) return 0xFF;
  const Brick& brick = grid.brick(as_key({x, y, z}));
  const auto layer = static_cast<std::size_t>(z & 7);
  const std::uint64_t word = unknown == UnknownPolicy::kBlock ? ~brick.free[layer] : brick.occupied[layer];
  return static_cast<Row>((word >> ((y & 7) * 8)) & 0xFF);
}

Rows load_blocked(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& corner) {
  Rows rows{};
  for (int z = 0; z < kPadded; ++z)
    for (int y = 0; y < kPadded; ++y) {
      const bool edge_z = z == 0 || z == kPadded - 1, edge_y = y == 0 || y == kPadded - 1;
      if (edge_z && edge_y) continue;
      const auto eight = [&](int dx) {
        return blocked_row_of_eight(grid, unknown, corner.x + dx, corner.y + y - 1, corner.z + z - 1);
      };
      Row row = 0;
      for (int dx = 0; dx < kUnitEdge; dx += 8) row |= eight(dx) << (dx + 1);
      if (!edge_z && !edge_y) row |= (eight(-8) >> 7) | ((eight(kUnitEdge) & 1U) << (kUnitEdge + 1));
      rows[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] = row;
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

void append_unit_boxes(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& corner,
                       std::vector<KeyBox>& boxes) {
  const Rows blocked = load_blocked(grid, unknown, corner);
  Rows uncovered = shell_of(blocked);
  const auto key = [&](const Cell& c) {
    return as_key({corner.x + c[0] - 1, corner.y + c[1] - 1, corner.z + c[2] - 1});
  };
  Grower grower(blocked, uncovered);
  for (int z = 1; z <= kUnitEdge; ++z)
    for (int y = 1; y <= kUnitEdge; ++y) {
      Row& row = uncovered[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)];
      while (row != 0) {
        grower.grow_from({std::countr_zero(row), y, z});
        boxes.push_back({key(grower.low()), key(grower.high())});
      }
    }
}

// Storage nodes seen by the edge of their children.
const Shared<Sector>& node_at(const VoxelGrid& grid, const VoxelKey& key, const Sector*) {
  return grid.storage()->child(key);
}
const Shared<Region>& node_at(const VoxelGrid& grid, const VoxelKey& key, const Region*) {
  return grid.storage()->child(key)->child(key);
}
const Shared<Tile>& node_at(const VoxelGrid& grid, const VoxelKey& key, const Tile*) {
  return grid.storage()->child(key)->child(key)->child(key);
}

class Units {
 public:
  Units(const VoxelGrid& grid, UnknownPolicy unknown) : grid_(grid), unknown_(unknown) {
    descend(*grid.storage(), {});
  }

  std::vector<KeyBox> whole_nodes;
  std::vector<VoxelKey> mixed_tiles;

 private:
  template <class Node>
  [[nodiscard]] bool blocks_everywhere(const Shared<Node>& node) const {
    return node == uniform_node<Node>(Occupancy::kOccupied) ||
           (unknown_ == UnknownPolicy::kBlock && node == uniform_node<Node>(Occupancy::kUnknown));
  }

  // Whether something beside an all-blocking node may be free.
  template <class Node>
  [[nodiscard]] bool is_shell(const VoxelKey& corner) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        auto beside = as_array(corner);
        beside[axis] += side * (1 << Node::kLog2);
        if (beside[axis] < 0 || beside[axis] >= Lattice::kKeysPerAxis) continue;
        if (!blocks_everywhere(node_at(grid_, as_key(beside), static_cast<const Node*>(nullptr))))
          return true;
      }
    return false;
  }

  template <class Node>
  void descend(const Node& node, const VoxelKey& corner) {
    using Child = typename Node::Child;
    for (int i = 0; i < Node::kChildren; ++i) {
      const auto& child = node.children[static_cast<std::size_t>(i)];
      const VoxelKey at = child_corner<Child::kLog2, Node::kChildBits>(corner, i);
      if (blocks_everywhere(child)) {
        constexpr int kLast = (1 << Child::kLog2) - 1;
        if (is_shell<Child>(at))
          whole_nodes.push_back({at, as_key({at.x + kLast, at.y + kLast, at.z + kLast})});
      } else if (child == uniform_node<Child>(Occupancy::kFree) ||
                 child == uniform_node<Child>(Occupancy::kUnknown)) {
        continue;
      } else if constexpr (std::is_same_v<Child, Tile>) {
        mixed_tiles.push_back(at);
      } else {
        descend(*child, at);
      }
    }
  }

  const VoxelGrid& grid_;
  UnknownPolicy unknown_;
};

}  // namespace

std::vector<KeyBox> make_blocker_boxes(const VoxelGrid& grid, UnknownPolicy unknown) {
  Units units(grid, unknown);
  std::vector<std::vector<KeyBox>> per_tile(units.mixed_tiles.size());
  for_each_piece(per_tile.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const VoxelKey& tile = units.mixed_tiles[i];
      for (int z = 0; z < 64; z += kUnitEdge)
        for (int y = 0; y < 64; y += kUnitEdge)
          for (int x = 0; x < 64; x += kUnitEdge)
            append_unit_boxes(grid, unknown, as_key({tile.x + x, tile.y + y, tile.z + z}), per_tile[i]);
    }
  });
  std::vector<KeyBox> boxes = std::move(units.whole_nodes);
  for (const auto& tile : per_tile) boxes.insert(boxes.end(), tile.begin(), tile.end());
  return boxes;
}

}  // namespace frontlux::detail
