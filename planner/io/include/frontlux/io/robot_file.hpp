#pragma once

#include <frontlux/export.hpp>
#include <frontlux/planner/robot.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace frontlux::io {

inline constexpr std::size_t kLongestRobotName = 40;

/// What a sensor measures at most: simulated scans of more rays take gigabytes, and more rays a second take
/// minutes for each.
inline constexpr std::uint64_t kMostRays = std::uint64_t{1} << 22;  // of a scan
inline constexpr std::uint64_t kMostRaysPerSecond = std::uint64_t{1} << 26;

/// Reads a robot from a JSON file; docs/robots.md shows one and says what each member means.
/// @throws std::runtime_error naming the file, the member, what is wrong and what to do
[[nodiscard]] FRONTLUX_EXPORT planner::RobotDescription read_robot(const std::filesystem::path& file);

}  // namespace frontlux::io
