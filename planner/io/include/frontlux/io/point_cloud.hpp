#pragma once

#include <frontlux/export.hpp>

#include <Eigen/Core>

#include <filesystem>
#include <vector>

namespace frontlux::io {

/// Reads the points of a PCD file (ascii or binary) or the vertices of a PLY file (`read_ply`) [m], by its
/// name's ending. Other fields and elements are left out. A coordinate may be NaN; it is infinite if too
/// large for a float.
/// @throws std::runtime_error naming the file, what is wrong, the line or byte where it is, and what to do
[[nodiscard]] FRONTLUX_EXPORT std::vector<Eigen::Vector3f> read_point_cloud(
    const std::filesystem::path& file);

}  // namespace frontlux::io
