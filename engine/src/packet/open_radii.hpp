#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace frontlux::detail {

/// Bricks of a table from `begin` to before `end`, along x, y and z.
struct BrickBox {
  std::array<std::size_t, 3> begin, end;
};

/// Measures `OpenVoxels::radii` anew where voxels have changed and as far around as they matter.
/// @param words    of the table
/// @param bricks   of the table, along x, y and z
/// @param changed  where voxels have changed
void measure_open_radii(const std::uint64_t* words, const std::array<std::size_t, 3>& bricks,
                        const BrickBox& changed, std::span<std::uint32_t> radii);

}  // namespace frontlux::detail
