#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace frontlux::planner::detail {

/// Writes a file complete or not at all: into a file beside it first, which then takes its name.
/// @param write  writes the bytes
/// @throws std::runtime_error naming the file, and what `write` throws
void write_whole_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

}  // namespace frontlux::planner::detail
