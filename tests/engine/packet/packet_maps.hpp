#pragma once

// Maps for the table of open voxels and for what walks through it.

#include "packet/open_voxels.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"

#include <frontlux/octomap.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace frontlux::test {

inline constexpr UnknownPolicy kPolicies[] = {UnknownPolicy::kBlock, UnknownPolicy::kPass};

// 40 x 40 x 40 voxels of noise in a corner of the key range.
inline VoxelGrid corner_grid(int corner, std::uint64_t seed) {
  VoxelGrid grid(0.25);
  Random random(seed);
  const auto key = [&](int i) { return static_cast<std::uint16_t>(corner == 0 ? i : 65535 - i); };
  for (int x = 0; x < 40; ++x)
    for (int y = 0; y < 40; ++y)
      for (int z = 0; z < 40; ++z)
        grid.set({key(x), key(y), key(z)}, random.one_in(30)   ? Occupancy::kOccupied
                                           : random.one_in(30) ? Occupancy::kUnknown
                                                               : Occupancy::kFree);
  return grid;
}

// A hall of 192 x 160 x 96 voxels with posts, slabs and specks, where most space is open.
inline VoxelGrid hall_grid(std::uint64_t seed) {
  VoxelGrid grid(0.1);
  Random random(seed);
  const auto key = [](int i) { return static_cast<std::uint16_t>(32700 + i); };
  const auto put = [&](const std::array<int, 3>& at, const std::array<int, 3>& size, Occupancy state) {
    for (int x = at[0]; x < std::min(at[0] + size[0], 192); ++x)
      for (int y = at[1]; y < std::min(at[1] + size[1], 160); ++y)
        for (int z = at[2]; z < std::min(at[2] + size[2], 96); ++z) grid.set({key(x), key(y), key(z)}, state);
  };
  put({0, 0, 0}, {192, 160, 96}, Occupancy::kFree);
  const auto somewhere = [&] { return std::array{random.below(192), random.below(160), random.below(96)}; };
  for (int i = 0; i < 6; ++i) put(somewhere(), {2, 3, 90}, Occupancy::kOccupied);
  for (int i = 0; i < 4; ++i) put(somewhere(), {40, 30, 1}, Occupancy::kOccupied);
  for (int i = 0; i < 30; ++i)
    put(somewhere(), {1, 1, 1}, i % 2 == 0 ? Occupancy::kOccupied : Occupancy::kUnknown);
  return grid;
}

inline std::vector<VoxelGrid> grids() {
  std::vector<VoxelGrid> grids;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    grids.push_back(make_voxel_grid(*make_random_tree(seed, 0.3)));  // as large as the key range: no table
    grids.push_back(make_voxel_grid(*make_noise_tree(seed, 0.3, 24)));
  }
  grids.push_back(corner_grid(0, 5));
  grids.push_back(corner_grid(65535, 6));
  grids.push_back(hall_grid(7));
  return grids;
}

// All of a map, and a part of it that is cut off on all four sides.
inline std::vector<KeyBox> windows(const VoxelGrid& grid) {
  const KeyBox known = *grid.known_bounds();
  const auto inner = [](int low, int high) {
    const int margin = (high - low) / 5;
    return std::array{(low + margin) & ~7, (high - margin) | 7};
  };
  const auto x = inner(known.min.x, known.max.x), y = inner(known.min.y, known.max.y);
  return {kAllVoxels, {make_key(x[0], y[0], 0), make_key(x[1], y[1], 65535)}};
}

inline detail::OpenVoxels table_of(const VoxelGrid& grid, UnknownPolicy unknown, const KeyBox& window) {
  return {grid, unknown, grid.known_bounds(), window};
}

}  // namespace frontlux::test
