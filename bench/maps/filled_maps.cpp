#include "maps/filled_maps.hpp"

#include "random.hpp"

#include <cmath>
#include <stdexcept>

namespace frontlux::bench {
namespace {

enum Stream : std::uint64_t { kBlock = 101, kDoor, kFurniture, kStreet, kSite };

/// A box by its lowest voxel and its edges, counted from the middle of the key range.
KeyBox box_at(int x, int y, int z, int width, int depth, int height) {
  constexpr int k = Lattice::kOrigin;
  return {make_key(k + x, k + y, k + z), make_key(k + x + width - 1, k + y + depth - 1, k + z + height - 1)};
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

void fill_part(VoxelGrid& grid, const KeyBox& box, Occupancy state, const Block& block) {
  const KeyBox extent = cube(block.corner, 1 << block.log2_edge);
  const auto common = intersection(extent, box);
  if (common == extent) {
    grid.fill(block, state);
  } else if (common) {
    for (unsigned i = 0; i < 8; ++i) fill_part(grid, box, state, octant(block, i));
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
    for (int k = 0; k < rooms_.z; ++k)
      for (int j = 0; j < rooms_.y; ++j)
        for (int i = 0; i < rooms_.x; ++i) open_and_furnish(i, j, k);
    return grid_;
  }

 private:
  static constexpr int kEdge = Rooms::kEdge, kHeight = Rooms::kHeight;
  static constexpr int kDoorWidth = 10, kDoorHeight = 21, kHatch = 8;
  static constexpr int kAisle = 12;  // free along the walls, so that doors are not blocked
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

namespace {

// A box of free voxels with occupied cubes of up to so many voxels' edge at random places in it.
VoxelGrid make_scattered(double resolution, int edge, int height, int largest, double fraction, Draws draws) {
  VoxelGrid grid(resolution);
  fill_box(grid, box_at(0, 0, 0, edge, edge, height), Occupancy::kFree);
  const double volume = static_cast<double>(edge) * edge * height;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(fraction * volume));
  for (std::uint64_t occupied = 0; occupied < wanted;) {
    const int size = draws.whole(1, largest);
    const int x = draws.whole(0, edge - size), y = draws.whole(0, edge - size),
              z = draws.whole(0, height - size);
    for_each_key(box_at(x, y, z, size, size, size), [&](const VoxelKey& key) {
      if (grid.at(key) == Occupancy::kOccupied) return;
      grid.set(key, Occupancy::kOccupied);
      ++occupied;
    });
  }
  return grid;
}

}  // namespace

VoxelGrid make_blocks(double fraction) {
  if (!(fraction >= 0.0 && fraction <= 0.5))
    throw std::invalid_argument("make_blocks: the occupied fraction is " + std::to_string(fraction) +
                                ", must be from 0 to 0.5");
  return make_scattered(kBlocksResolution, kBlocksEdge, kBlocksHeight, 4, fraction, Draws(kBlock, 0));
}

VoxelGrid make_site() { return make_scattered(0.05, 1200, 120, 16, 0.01, Draws(kSite, 0)); }

VoxelGrid make_rooms(const Rooms& rooms) {
  constexpr int kKeys = Lattice::kKeysPerAxis - Lattice::kOrigin - 1;
  if (rooms.x < 1 || rooms.y < 1 || rooms.z < 1 || rooms.x > kKeys / Rooms::kEdge ||
      rooms.y > kKeys / Rooms::kEdge || rooms.z > kKeys / Rooms::kHeight) {
    throw std::invalid_argument("make_rooms: no map of " + std::to_string(rooms.x) + " x " +
                                std::to_string(rooms.y) + " x " + std::to_string(rooms.z) + " rooms");
  }
  return Builder(rooms).build();
}

VoxelGrid make_town(int edge) {
  constexpr int kPitch = 1000, kWidth = 48, kWall = 8, kGround = 8, kHeight = 32;  // in whole bricks
  constexpr int kCubesPerKilometre = 2000;
  constexpr double kResolution = 0.2;
  if (edge < kWidth || edge > Lattice::kKeysPerAxis - Lattice::kOrigin - kPitch)
    throw std::invalid_argument("make_town: no town of " + std::to_string(edge) + " voxels");
  VoxelGrid grid(kResolution);
  const int streets = 1 + (edge - kWidth) / kPitch;
  const auto for_each_street = [&](const auto& visit) {
    for (int street = 0; street < streets; ++street)
      for (const bool along_x : {false, true})
        visit(2 * street + (along_x ? 1 : 0),
              [street, along_x](int along, int across, int z, int length, int width, int height) {
                const int at = street * kPitch + across;
                return along_x ? box_at(along, at, z, length, width, height)
                               : box_at(at, along, z, width, length, height);
              });
  };
  for_each_street([&](int, const auto& box) {
    fill_box(grid, box(0, -kWall, 0, edge, kWidth + 2 * kWall, kGround + kHeight), Occupancy::kOccupied);
  });
  for_each_street([&](int, const auto& box) {
    fill_box(grid, box(0, 0, kGround, edge, kWidth, kHeight), Occupancy::kFree);
  });
  for_each_street([&](int street, const auto& box) {
    Draws draws(kStreet, static_cast<std::uint64_t>(street) << 32U);
    for (int cubes = static_cast<int>(edge * kResolution / 1000 * kCubesPerKilometre); cubes > 0; --cubes) {
      const int size = draws.whole(1, 4);
      const int along = draws.whole(0, edge - size), across = draws.whole(0, kWidth - size),
                z = kGround + draws.whole(0, kHeight - size);
      fill_box(grid, box(along, across, z, size, size, size), Occupancy::kOccupied);
    }
  });
  return grid;
}

std::uint64_t count_known(const VoxelGrid& grid) {
  const auto count = grid.count();
  return count[static_cast<std::size_t>(Occupancy::kFree)] +
         count[static_cast<std::size_t>(Occupancy::kOccupied)];
}

}  // namespace frontlux::bench
