#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/robot.hpp>

#include <cstddef>
#include <filesystem>

namespace frontlux::io {

inline constexpr std::size_t kLongestRobotName = 40;

/// Reads a robot from a JSON file; docs/robots.md shows one and says what each member means.
/// @throws std::runtime_error naming the file, the member, what is wrong and what to do
[[nodiscard]] FRONTLUX_EXPORT planner::RobotDescription read_robot(const std::filesystem::path& file);

}  // namespace frontlux::io
