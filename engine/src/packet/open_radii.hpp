#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::detail {

/// `OpenVoxels::radii`, from the table's words.
/// @param x_bricks, y_bricks, z_bricks  of the table
[[nodiscard]] std::vector<std::uint32_t> open_radii(const std::uint64_t* words, std::size_t x_bricks,
                                                    std::size_t y_bricks, std::size_t z_bricks);

}  // namespace frontlux::detail
