#pragma once

#include <frontlux/synthetic/box_set.hpp>

#include <cstdint>
#include <vector>

namespace frontlux::synthetic {

/// A closed room full of solid boxes: the ground truth of a synthetic map. World frame, z up.
///
/// No face coincides with a voxel face of a map whose resolution is a multiple of 0.05 m. The building's lie
/// 3 cm within their solid, seen from a multiple of 0.3 m, the lowest floor's top at z = -0.03 m: inside the
/// solid's first layer of voxels at 0.1 m and 0.3 m, so that surfaces come out smooth. Those of the room
/// lie 3 cm above a multiple of 0.1 m, the floor's top at z = -0.07 m: some amid a voxel.
struct Scene {
  BoxSet solids;
  Box room;                    ///< inside of the outer walls, floor and roof [m]
  std::vector<double> floors;  ///< heights of the storeys' floors [m]
};

/// 77 x 77 x 10 m: two storeys of rooms, corridors and furniture around a hall, which like the rooms on the
/// east side is as high as the house. Doors join the rooms of a storey, galleries both storeys with the hall.
[[nodiscard]] Scene make_building_scene(std::uint64_t seed);

/// 6 x 5 x 3 m: a furnished room and a side room behind a door.
[[nodiscard]] Scene make_room_scene(std::uint64_t seed);

}  // namespace frontlux::synthetic
