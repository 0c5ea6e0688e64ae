#pragma once

#include <frontlux/voxel_grid.hpp>

#include <cstdint>

namespace frontlux::bench {

/// Sets every voxel of a box. The time grows with its surface, not its volume.
void fill_box(VoxelGrid& grid, const KeyBox& box, Occupancy state);

/// The box of `make_blocks`: 96 x 96 x 6.4 m in voxels of 0.2 m.
inline constexpr int kBlocksEdge = 480, kBlocksHeight = 32;
inline constexpr double kBlocksResolution = 0.2;

/// A box of free voxels with occupied cubes of one to four voxels' edge at random places in it, until at
/// least a fraction of its voxels is occupied.
/// @throws std::invalid_argument unless the fraction is from 0 to 0.5
[[nodiscard]] VoxelGrid make_blocks(double fraction);

/// A large free space: 60 x 60 x 6 m of free voxels of 0.05 m, 1 % of them in occupied cubes of up to 0.8 m's
/// edge at random places.
[[nodiscard]] VoxelGrid make_site();

/// Storeys of equal rooms, 6.4 x 6.4 x 3.2 m each, in voxels of 0.1 m: walls, floors and ceilings one voxel
/// thick, doors in all inner walls, a hatch to the room below, and four solid boxes in every room, no two
/// rooms alike. Everything is known except the inside of the boxes.
struct Rooms {
  int x = 1, y = 1, z = 1;  ///< number along each axis

  static constexpr int kEdge = 64, kHeight = 32;  ///< [voxels] from wall to wall, from floor to floor
  static constexpr double kResolution = 0.1;      ///< [m]
};

/// @throws std::invalid_argument unless there is a room and all fit into the key range
[[nodiscard]] VoxelGrid make_rooms(const Rooms& rooms);

/// Streets of a town, 9.6 m wide and 200 m apart, with walls on both sides and occupied cubes of one to four
/// voxels' edge in them, 6.4 m high, in voxels of 0.2 m. What lies between the streets is unknown.
/// @param edge  [voxels] of the square that the town lies in
/// @throws std::invalid_argument unless a street fits into it, and it into the key range
[[nodiscard]] VoxelGrid make_town(int edge);

/// Free and occupied voxels.
[[nodiscard]] std::uint64_t count_known(const VoxelGrid& grid);

}  // namespace frontlux::bench
