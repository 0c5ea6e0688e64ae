#include "scaling/maps.hpp"

#include "random.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace frontlux::bench {
namespace {

enum Stream : std::uint64_t { kBlock = 101, kDoor, kFurniture };

/// A box by its lowest voxel and its edges, counted from the middle of the key range.
KeyBox box_at(int x, int y, int z, int width, int depth, int height) {
  const auto key = [](int i) { return static_cast<std::uint16_t>(Lattice::kOrigin + i); };
  return {{key(x), key(y), key(z)}, {key(x + width - 1), key(y + depth - 1), key(z + height - 1)}};
}

/// Numbers for one purpose, drawn one after the other.
class Draws {
 public:
  Draws(std::uint64_t stream, std::uint64_t first) : stream_(stream), next_(first) {}
  /// low, low + 1, ..., high
  int whole(int low, int high) {
    return low + static_cast<int>(uniform(stream_, next_++) * static_cast<double>(high - low + 1));
  }

 private:
  std::uint64_t stream_, next_;
};

bool meets(const KeyBox& a, const KeyBox& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
         a.min.z <= b.max.z && b.min.z <= a.max.z;
}

void fill_part(VoxelGrid& grid, const KeyBox& box, Occupancy state, const Block& block) {
  const auto last = static_cast<std::uint16_t>((1U << block.log2_edge) - 1);
  const auto plus = [](std::uint16_t key, std::uint16_t step) {
    return static_cast<std::uint16_t>(key + step);
  };
  const KeyBox extent{block.corner,
                      {plus(block.corner.x, last), plus(block.corner.y, last), plus(block.corner.z, last)}};
  if (!meets(extent, box)) return;
  if (box.contains(extent.min) && box.contains(extent.max)) {
    grid.fill(block, state);
    return;
  }
  const auto half = static_cast<std::uint16_t>(1U << (block.log2_edge - 1));
  for (unsigned i = 0; i < 8; ++i) {
    const auto step = [&](unsigned bit) { return ((i >> bit) & 1U) != 0 ? half : std::uint16_t{0}; };
    const VoxelKey corner{plus(block.corner.x, step(0)), plus(block.corner.y, step(1)),
                          plus(block.corner.z, step(2))};
    fill_part(grid, box, state, {corner, block.log2_edge - 1});
  }
}

/// Builds rooms in one grid.
class Builder {
 public:
  explicit Builder(const Rooms& rooms) : rooms_(rooms), grid_(Rooms::kResolution) {}

  VoxelGrid build() {
    const int width = rooms_.x * kEdge, depth = rooms_.y * kEdge, height = rooms_.z * kHeight;
    fill(box_at(0, 0, 0, width + 1, depth + 1, height + 1), Occupancy::kFree);
    for (int i = 0; i <= rooms_.x; ++i)
      fill(box_at(i * kEdge, 0, 0, 1, depth + 1, height + 1), Occupancy::kOccupied);
    for (int j = 0; j <= rooms_.y; ++j)
      fill(box_at(0, j * kEdge, 0, width + 1, 1, height + 1), Occupancy::kOccupied);
    for (int k = 0; k <= rooms_.z; ++k)
      fill(box_at(0, 0, k * kHeight, width + 1, depth + 1, 1), Occupancy::kOccupied);
    for (int k = 0; k < rooms_.z; ++k) {
      for (int j = 0; j < rooms_.y; ++j) {
        for (int i = 0; i < rooms_.x; ++i) open_and_furnish(i, j, k);
      }
    }
    return grid_;
  }

 private:
  static constexpr int kEdge = Rooms::kEdge, kHeight = Rooms::kHeight;
  static constexpr int kDoorWidth = 10, kDoorHeight = 21, kHatch = 8;
  static constexpr int kAisle = 12;  // free along the walls, so that nothing stands before a door
  static constexpr int kBoxes = 4, kDrawsPerBox = 5;

  void fill(const KeyBox& box, Occupancy state) { fill_box(grid_, box, state); }

  void open_and_furnish(int i, int j, int k) {
    const auto number = static_cast<std::uint64_t>((k * rooms_.y + j) * rooms_.x + i);
    const int x = i * kEdge, y = j * kEdge, z = k * kHeight;
    Draws door(kDoor, 2 * number);
    const int along_y = door.whole(2, kEdge - kDoorWidth - 1),
              along_x = door.whole(2, kEdge - kDoorWidth - 1);
    if (i > 0) fill(box_at(x, y + along_y, z + 1, 1, kDoorWidth, kDoorHeight), Occupancy::kFree);
    if (j > 0) fill(box_at(x + along_x, y, z + 1, kDoorWidth, 1, kDoorHeight), Occupancy::kFree);
    if (k > 0) fill(box_at(x + 2, y + 2, z, kHatch, kHatch, 1), Occupancy::kFree);

    for (std::uint64_t box = 0; box < kBoxes; ++box) {
      Draws draws(kFurniture, (number * kBoxes + box) * kDrawsPerBox);
      const int width = draws.whole(4, 16), depth = draws.whole(4, 16), height = draws.whole(4, 20);
      const int left = x + draws.whole(kAisle, kEdge - kAisle - width);
      const int front = y + draws.whole(kAisle, kEdge - kAisle - depth);
      fill(box_at(left, front, z + 1, width, depth, height), Occupancy::kOccupied);
      fill(box_at(left + 1, front + 1, z + 2, width - 2, depth - 2, height - 2), Occupancy::kUnknown);
    }
  }

  Rooms rooms_;
  VoxelGrid grid_;
};

}  // namespace

void fill_box(VoxelGrid& grid, const KeyBox& box, Occupancy state) { fill_part(grid, box, state, {{}, 16}); }

VoxelGrid make_blocks(double share) {
  if (!(share >= 0.0 && share <= 0.5)) {
    throw std::invalid_argument("make_blocks: share is " + std::to_string(share) + ", must be from 0 to 0.5");
  }
  VoxelGrid grid(kBlocksResolution);
  const KeyBox room = box_at(0, 0, 0, kBlocksEdge, kBlocksEdge, kBlocksHeight);
  fill_box(grid, room, Occupancy::kFree);
  const auto wanted = static_cast<std::uint64_t>(
      std::ceil(share * static_cast<double>(kBlocksEdge * kBlocksEdge * kBlocksHeight)));
  Draws draws(kBlock, 0);
  for (std::uint64_t occupied = 0; occupied < wanted;) {
    const int edge = draws.whole(1, 4);
    const int x = draws.whole(0, kBlocksEdge - edge), y = draws.whole(0, kBlocksEdge - edge),
              z = draws.whole(0, kBlocksHeight - edge);
    const KeyBox cube = box_at(x, y, z, edge, edge, edge);
    for (int i = 0; i < edge * edge * edge; ++i) {
      const VoxelKey key{static_cast<std::uint16_t>(cube.min.x + i % edge),
                         static_cast<std::uint16_t>(cube.min.y + i / edge % edge),
                         static_cast<std::uint16_t>(cube.min.z + i / edge / edge)};
      if (grid.at(key) == Occupancy::kOccupied) continue;
      grid.set(key, Occupancy::kOccupied);
      ++occupied;
    }
  }
  return grid;
}

VoxelGrid make_rooms(const Rooms& rooms) {
  const int room_in_range = Lattice::kKeysPerAxis - Lattice::kOrigin - 1;
  if (rooms.x < 1 || rooms.y < 1 || rooms.z < 1 || rooms.x > room_in_range / Rooms::kEdge ||
      rooms.y > room_in_range / Rooms::kEdge || rooms.z > room_in_range / Rooms::kHeight) {
    throw std::invalid_argument("make_rooms: no map of " + std::to_string(rooms.x) + " x " +
                                std::to_string(rooms.y) + " x " + std::to_string(rooms.z) + " rooms");
  }
  return Builder(rooms).build();
}

std::uint64_t count_known(const VoxelGrid& grid) {
  const auto count = grid.count();
  return count[static_cast<std::size_t>(Occupancy::kFree)] +
         count[static_cast<std::size_t>(Occupancy::kOccupied)];
}

}  // namespace frontlux::bench
