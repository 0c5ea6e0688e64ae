#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/pose.hpp>

#include <filesystem>
#include <span>

namespace frontlux::io {

/// Writes the viewpoints of a path. The file appears complete or not at all.
///
/// A name that ends in `.csv`: a line `x,y,z,yaw` for each [m, rad], below one with these words; the numbers
/// read back as the same. One that ends in `.ply`: for each a point whose normal is the direction of view and
/// the tip of an arrow of 0.3 m in that direction, and as edges the arrows and the path.
/// @throws std::invalid_argument if the name ends otherwise
/// @throws std::runtime_error naming the file, if it cannot be written
FRONTLUX_EXPORT void write_path(const std::filesystem::path& file, std::span<const planner::Pose> viewpoints);

}  // namespace frontlux::io
